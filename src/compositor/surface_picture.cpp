// Keeps the picture of the real surface beside the scene, with a key that says what it was made from.
#include "compositor/surface_picture.h"

#include <cmath>
#include <locale>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include "compositor/sensor.h"
#include "compositor/surface_frames.h"
#include "compositor/surface_holdouts.h"
#include "core/content_hash.h"
#include "core/error.h"
#include "core/version.h"
#include "media/exr_file.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

namespace fs = std::filesystem;

constexpr const char* key_name = "matchlight_surface";
constexpr const char* rectangle_name = "matchlight_rectangle_m";
const std::vector<std::string> radiance_channels{"R", "G", "B", "A"};

std::string surface_key(const Scene& scene, const Solve& solve, const SurfacePictureOptions& options) {
    ContentHash hash;
    hash.add(version);
    hash.add_file(scene.footage.solve);
    if (is_pattern(scene.footage.video)) {
        const std::vector<std::int64_t> numbers = numbers_of_pattern(scene.footage.video);
        for (const SolvedFrame* frame : spread_frames(solve, options.most_frames)) {
            const auto index = static_cast<std::size_t>(frame->frame);
            if (index < numbers.size()) hash.add_file(numbered(scene.footage.video, numbers[index]));
        }
    } else {
        // A clip can be as large as a disk: its size stands for it, as its frames' places do in the solve.
        std::error_code failure;
        hash.add(std::to_string(fs::file_size(scene.footage.video, failure)));
    }
    hash.add(scene.footage.color_matrix.value_or(""));
    hash.add(scene.footage.color_range.value_or(""));
    if (!scene.footage.ocio_config.empty()) hash.add_file(scene.footage.ocio_config);
    hash.add(scene.footage.ocio_space);
    add_holdouts(hash, scene, solve, spread_frames(solve, options.most_frames));
    const std::array<double, 2> vignette = vignette_of(scene.effects.vignette, solve);
    hash.add(fmt::format("{} {} {} {} {}", scene.surface.z_m, vignette[0], vignette[1], options.most_frames,
                         options.most_texels));
    return hash.hex();
}

std::optional<std::string> text_of(const Imf::Header& header, const char* name) {
    const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name);
    return text != nullptr ? std::optional(text->value()) : std::nullopt;
}

/// What is in the file; nullopt where there is none, or it was made from something else, or is damaged: then it is made
/// again.
std::optional<GatheredSurface> load_surface(const fs::path& path, const std::string& key) {
    std::error_code missing;
    if (!fs::is_regular_file(path, missing)) return std::nullopt;
    try {
        const ExrFile file(path);
        if (text_of(file.header(0), key_name) != key) return std::nullopt;
        double corner[4] = {};
        std::istringstream rectangle(text_of(file.header(0), rectangle_name).value_or(""));
        rectangle.imbue(std::locale::classic());
        for (double& value : corner) rectangle >> value;
        if (!rectangle || !(corner[2] > corner[0]) || !(corner[3] > corner[1])) return std::nullopt;
        GatheredSurface gathered{read_exr_part(path, "radiance", radiance_channels),
                                 read_exr_part(path, "clipped", {"clipped"}),
                                 {Eigen::Vector2d(corner[0], corner[1]), Eigen::Vector2d(corner[2], corner[3])}};
        if (gathered.clipped.width() != gathered.radiance.width() ||
            gathered.clipped.height() != gathered.radiance.height())
            return std::nullopt;
        for (const float value : gathered.radiance.samples()) {
            if (!std::isfinite(value) || value < 0) return std::nullopt;
        }
        return gathered;
    } catch (const InputError&) {
        return std::nullopt;
    }
}

void save_surface(const fs::path& path, const std::string& key, const GatheredSurface& gathered) {
    const Eigen::Vector2d low = gathered.rectangle_m.min(), high = gathered.rectangle_m.max();
    write_exr(path, gathered.radiance.width(), gathered.radiance.height(),
              {{.name = "radiance", .channels = radiance_channels, .image = &gathered.radiance, .data_window = {}},
               {.name = "clipped", .channels = {"clipped"}, .image = &gathered.clipped, .data_window = {}}},
              {{key_name, key}, {rectangle_name, fmt::format("{} {} {} {}", low.x(), low.y(), high.x(), high.y())}});
}

}  // namespace

fs::path surface_picture_file_of(const Scene& scene) {
    return scene.path.parent_path() / (scene.path.stem().string() + ".surface.exr");
}

std::shared_ptr<const GatheredSurface> surface_picture_of_clip(const Scene& scene, const Solve& solve,
                                                               const SurfacePictureOptions& options,
                                                               Warnings& warnings) {
    // Draft quality looks at the probe alone.
    const bool looked_at = !scene.objects.empty() && scene.quality != QualityLevel::draft;
    if (!options.needed || !looked_at || scene.camera || !scene.surface.present) return nullptr;
    const fs::path path = surface_picture_file_of(scene);
    const std::string key = surface_key(scene, solve, options);
    std::optional<GatheredSurface> gathered = load_surface(path, key);
    if (!gathered) {
        Warnings unheard;  // rendering will say the same of the footage
        unheard.set_quiet(true);
        gathered = gather_surface(scene, solve, options, unheard);
        if (!gathered) return nullptr;
        try {
            save_surface(path, key, *gathered);
        } catch (const InputError& error) {
            warnings.add(fmt::format("{}; every run gathers the surface's picture again", error.what()));
        }
    }
    return std::make_shared<const GatheredSurface>(std::move(*gathered));
}

}  // namespace matchlight
