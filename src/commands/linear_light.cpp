// Reading of light.
#include "commands/linear_light.h"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "media/image_io.h"
#include "media/picture_format.h"

namespace matchlight {

namespace fs = std::filesystem;

void add_light_options(CLI::App& command, LightOptions& options) {
    command
        .add_option("--response", options.response,
                    "The camera's curve: a response.json, srgb (default), linear or gamma=2.2; raw files need none")
        ->type_name("FILE|FAMILY");
    add_exposure_options(command, options.exposures);
    command.add_flag("--deghost", options.deghost,
                     "Leave photographs out where they show something else; may cost small lamps some of their light");
}

LinearLight read_light(const std::vector<fs::path>& files, const LightOptions& options, Warnings& warnings) {
    const auto is_linear = [](const fs::path& path) {
        const std::string extension = path.extension().string();
        return extension == ".exr" || extension == ".hdr" || extension == ".EXR" || extension == ".HDR";
    };
    LinearLight result;
    std::vector<std::string> names;
    for (const fs::path& file : files) names.push_back(file.filename().string());
    result.sources = fmt::format("{}", fmt::join(names, ", "));
    if (std::ranges::any_of(files, is_linear)) {
        if (files.size() > 1) {
            throw InputError(*std::ranges::find_if(files, is_linear),
                             "is linear light beside other pictures of the same view",
                             "give it alone, or photographs alone");
        }
        result.light = read_linear_rgb(files.front(), warnings);
        std::int64_t negative = 0;
        for (float& sample : result.light.samples()) {
            if (sample >= 0) continue;
            sample = 0;
            ++negative;
        }
        if (negative > 0) {
            warnings.add(
                fmt::format("{}: {} samples are negative and were set to 0", files.front().string(), negative));
        }
        return result;
    }
    PhotographOptions photographs = options.exposures;
    photographs.photographs = files;
    const ExposureSeries series = read_photographs(photographs, warnings);
    MergeOptions merging;
    merging.align = options.align;
    merging.deghost = options.deghost;
    MergedPhotograph merged = merge_exposures(series, response_of(options.response), merging, warnings);
    result.light = std::move(merged.radiance);
    result.exposure = merged.exposures[merged.reference];
    result.clipped_pixels = merged.clipped_pixels;
    result.clipped = ImageF(series.width(), series.height(), 1);
    for (int y = 0; y < series.height(); ++y) {
        for (int x = 0; x < series.width(); ++x) {
            const std::uint8_t* flags = merged.flags.pixel(x, y);
            if (((flags[0] | flags[1] | flags[2]) & merge_flag::clipped) != 0) result.clipped.at(x, y) = 1;
        }
    }
    return result;
}

}  // namespace matchlight
