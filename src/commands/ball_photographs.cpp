// The photographs of balls that `probe build` is given, read and merged into views of one unit.
#include "commands/ball_photographs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "calibration/exposure_series.h"
#include "commands/photograph_options.h"
#include "core/error.h"
#include "core/lowercase.h"
#include "media/exr_file.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(const std::vector<std::string>& given) {
    std::vector<fs::path> files;
    for (const std::string& one : given) {
        if (!fs::is_directory(one)) {
            files.emplace_back(one);
            continue;
        }
        std::vector<fs::path> inside;
        for (const auto& entry : fs::directory_iterator(one)) {
            if (entry.is_regular_file()) inside.push_back(entry.path());
        }
        if (inside.empty()) throw InputError(one, "the folder holds no photograph");
        std::ranges::sort(inside);
        files.insert(files.end(), inside.begin(), inside.end());
    }
    return files;
}

bool is_merged(const std::vector<fs::path>& files) {
    const std::string extension = lowercase_extension(files.front());
    return files.size() == 1 && (extension == ".exr" || extension == ".hdr");
}

/// What is no deviation is as unsure as the light itself.
void repair_sigma(BallView& view, Warnings& warnings) {
    std::int64_t repaired = 0;
    for (std::size_t i = 0; i < view.sigma.samples().size(); ++i) {
        float& sigma = view.sigma.samples()[i];
        if (std::isfinite(sigma) && sigma >= 0) continue;
        sigma = view.radiance.samples()[i];
        ++repaired;
    }
    if (repaired == 0) return;
    warnings.add(fmt::format("{}: {} samples of sigma are negative or no numbers and were set to the light's own",
                             view.name.string(), repaired));
}

}  // namespace

BallView BallPhotographs::read(const std::vector<std::string>& given, Warnings& warnings) {
    const std::vector<fs::path> files = files_of(given);
    check_not_an_input(output_, files);
    const bool merged = is_merged(files);
    if (!sources_.empty() && merged == scale_.has_value()) {
        throw InputError(files.front(),
                         "its units are not those of the views before: one is merged already, one is not",
                         "give photographs of all, or all merged alike");
    }
    for (const fs::path& file : files) sources_.push_back(file.filename().string());
    return merged ? merged_before(files.front(), warnings) : merged_here(files, warnings);
}

BallView BallPhotographs::merged_before(const fs::path& file, Warnings& warnings) const {
    BallView view;
    view.name = file;
    view.radiance = read_linear_rgb(file, warnings);
    const int width = view.radiance.width(), height = view.radiance.height();
    view.camera = camera_for_size(reading_.camera, width, height, file);
    if (lowercase_extension(file) != ".exr") return view;
    const ExrFile exr(file);
    if (exr.has_channel(0, "sigma.R")) {
        view.sigma = exr.read(0, {"sigma.R", "sigma.G", "sigma.B"});
        repair_sigma(view, warnings);
    }
    if (exr.has_channel(0, "clipped")) {
        const ImageF flags = exr.read(0, {"clipped"});
        view.clipped = Image8(width, height, 1);
        std::ranges::transform(flags.samples(), view.clipped.samples().begin(),
                               [](float flag) -> std::uint8_t { return flag > 0 ? 255 : 0; });
    }
    return view;
}

BallView BallPhotographs::merged_here(const std::vector<fs::path>& photographs, Warnings& warnings) {
    const ExposureSeries series = read_exposure_series(photographs, {}, warnings);
    BallView view;
    view.name = photographs.front();
    view.camera = camera_for_size(reading_.camera, series.width(), series.height(), photographs.front());
    MergedPhotograph merged = merge_exposures(series, reading_.response, reading_.merge, warnings);
    if (!scale_) scale_ = merged.exposures[merged.reference];
    for (float& sample : merged.radiance.samples()) sample *= static_cast<float>(*scale_);
    for (float& sample : merged.sigma.samples()) sample *= static_cast<float>(*scale_);
    view.clipped = Image8(series.width(), series.height(), 1);
    for (int y = 0; y < series.height(); ++y) {
        for (int x = 0; x < series.width(); ++x) {
            const std::uint8_t* flags = merged.flags.pixel(x, y);
            if (((flags[0] | flags[1] | flags[2]) & merge_flag::clipped) != 0) view.clipped.at(x, y) = 255;
        }
    }
    view.radiance = std::move(merged.radiance);
    view.sigma = std::move(merged.sigma);
    return view;
}

}  // namespace matchlight
