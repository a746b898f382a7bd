// Draws, reads, adapts; the file's key says what it was made from.
#include "compositor/exposure_meter.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compositor/compositor.h"
#include "core/atomic_file.h"
#include "core/content_hash.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/stop.h"
#include "core/version.h"
#include "render/effects/exposure.h"
#include "scene/footage_options.h"
#include "scene/model.h"
#include "scene/sphere_file.h"
#include "tracking/scene_solve.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What the meter found in a frame, and how the frame is exposed for it.
struct MeteredFrame {
    std::int64_t frame = 0;
    double time_s = 0;
    MeterReading reading;
    FrameExposure exposure;
};

/// Settings that change what the meter sees: not how results are encoded, nor effects other than exposure.
std::string metered_settings(const std::string& effective_toml) {
    std::istringstream text(effective_toml);
    std::string lines, section;
    for (std::string line; std::getline(text, line);) {
        if (line.starts_with('[')) section = line;
        if (section == "[output]" || section == "[quality]") continue;
        if (section == "[effects]" && !line.starts_with("exposure ")) continue;
        lines += line + '\n';
    }
    return lines;
}

std::string meter_key(const Scene& scene) {
    ContentHash hash;
    Warnings unheard;  // the compositor will say the same
    unheard.set_quiet(true);
    hash.add(version);
    hash.add(metered_settings(scene.effective_toml));
    if (scene.probe) hash.add_file(scene.probe->path);
    if (!scene.background.image.empty()) hash.add_file(scene.background.image);
    for (const ObjectSettings& object : scene.objects) {
        if (!object.model.empty()) add_model_contents(hash, object.model, unheard);
        if (!object.spheres.empty()) add_sphere_contents(hash, object.spheres);
        if (!object.material.texture.empty()) hash.add_file(object.material.texture);
    }
    if (!scene.camera) {
        hash.add_file(scene.footage.solve);
        // A clip can be as large as a disk: its size stands for it, as its frames' places do in the solve.
        std::error_code failure;
        hash.add(std::to_string(fs::file_size(scene.footage.video, failure)));
    }
    return hash.hex();
}

json optional_number(const std::optional<double>& value) {
    return value ? json(*value) : json(nullptr);
}

void save_meter(const fs::path& path, const std::string& key, const std::vector<MeteredFrame>& frames) {
    json list = json::array();
    for (const MeteredFrame& frame : frames) {
        list.push_back({{"frame", frame.frame},
                        {"time_s", frame.time_s},
                        {"log2_average", optional_number(frame.reading.log2_average)},
                        {"log2_maximum", optional_number(frame.reading.log2_maximum)},
                        {"exposure_ev", frame.exposure.ev},
                        {"white", frame.exposure.white}});
    }
    const json root{{"matchlight_meter", 1}, {"key", key}, {"version", version}, {"frames", std::move(list)}};
    write_text_file(path, root.dump(1) + "\n");
}

/// The exposures in a meter file; empty where there is none, or it was made from something else, or is damaged: then it
/// is made again.
std::vector<MeteredFrame> load_meter(const fs::path& path, const std::string& key) {
    std::error_code missing;
    if (!fs::is_regular_file(path, missing)) return {};
    try {
        const json root = json::parse(read_text_file(path, std::size_t{1} << 30));
        if (root.at("matchlight_meter") != 1 || root.at("key") != key) return {};
        std::vector<MeteredFrame> frames;
        for (const json& item : root.at("frames")) {
            MeteredFrame frame{.frame = item.at("frame"), .time_s = item.at("time_s"), .reading = {}, .exposure = {}};
            frame.exposure = {item.at("exposure_ev"), item.at("white")};
            if (!std::isfinite(frame.exposure.ev) || !(frame.exposure.white > 0)) return {};
            frames.push_back(frame);
        }
        return frames;
    } catch (const json::exception&) {
        return {};
    }
}

/// The scene as the meter draws it: small (a picture as background keeps its size), unexposed, without effects.
Scene scene_of_meter(const Scene& scene) {
    constexpr int longest_side_px = 256;
    Scene metered = scene;
    metered.effects = {};
    metered.reflections.reset();
    metered.bounce.reset();
    if (!metered.camera) return metered;
    CameraSettings& camera = *metered.camera;
    camera.exposure_ev = 0;
    const int side = std::max(camera.width, camera.height);
    if (!scene.background.image.empty() || side <= longest_side_px) return metered;
    camera.width = std::max(1, static_cast<int>(std::lround(double{longest_side_px} * camera.width / side)));
    camera.height = std::max(1, static_cast<int>(std::lround(double{longest_side_px} * camera.height / side)));
    return metered;
}

/// Plate-linear light · 2^−ev is scene-linear.
double footage_exposure_ev(const Solve& solve, std::int64_t frame) {
    const SolvedFrame* solved = solve.find(frame);
    const SolvedFrame* exposed = solved != nullptr ? solve.exposed_near(*solved) : nullptr;
    return exposed != nullptr ? *exposed->exposure_ev : 0;
}

std::vector<MeteredFrame> metered_frames(const Solve& full_solve, const Scene& scene, GlContext& context,
                                         const MeterPassOptions& options) {
    Warnings unheard;  // rendering will say the same
    unheard.set_quiet(true);
    const Scene metered = scene_of_meter(scene);
    const Solve solve = metered.camera ? virtual_solve(metered) : full_solve;
    const std::unique_ptr<FrameSource> source = open_frames(metered, options.strict, unheard);
    Compositor compositor(context, metered, solve, {.quality = QualityLevel::preview}, unheard);
    std::vector<MeteredFrame> frames;
    Progress progress("meter", source->info().frame_count, options.quiet);
    while (const std::optional<PlateFrame> plate = source->next()) {
        MeteredFrame frame{.frame = plate->index(), .time_s = plate->time_s(), .reading = {}, .exposure = {}};
        frame.reading = read_meter(compositor.meter_map(*plate), *scene.effects.exposure);
        const double ev = metered.camera ? 0 : footage_exposure_ev(solve, frame.frame);
        if (frame.reading.log2_average) *frame.reading.log2_average -= ev;
        if (frame.reading.log2_maximum) *frame.reading.log2_maximum -= ev;
        frames.push_back(frame);
        progress.advance();
        if (stop_requested()) throw InputError(scene.path, frame.frame, "metering was stopped by a signal");
    }
    return frames;
}

void adapt(std::vector<MeteredFrame>& frames, const ExposureSettings& settings) {
    std::vector<MeterReading> readings;
    std::vector<double> times_s;
    for (const MeteredFrame& frame : frames) {
        readings.push_back(frame.reading);
        times_s.push_back(frame.time_s);
    }
    const std::vector<FrameExposure> exposures = exposures_of_clip(readings, times_s, settings);
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].exposure = exposures[i];
}

}  // namespace

bool exposure_is_simulated(const Scene& scene) {
    return scene.effects.exposure && scene.effects.exposure->mode == ExposureMode::simulated;
}

fs::path meter_file_of(const Scene& scene) {
    return scene.path.parent_path() / (scene.path.stem().string() + ".meter.json");
}

void meter_clip(Solve& solve, const Scene& scene, GlContext& context, const MeterPassOptions& options,
                Warnings& warnings) {
    if (!exposure_is_simulated(scene)) return;
    const fs::path path = meter_file_of(scene);
    const std::string key = meter_key(scene);
    std::vector<MeteredFrame> frames = load_meter(path, key);
    if (frames.empty()) {
        frames = metered_frames(solve, scene, context, options);
        adapt(frames, *scene.effects.exposure);
        try {
            save_meter(path, key, frames);
        } catch (const InputError& error) {
            warnings.add(fmt::format("{}; every run meters the clip again", error.what()));
        }
    }
    std::size_t next = 0;
    for (SolvedFrame& solved : solve.frames) {
        while (next < frames.size() && frames[next].frame < solved.frame) ++next;
        if (next == frames.size()) break;
        if (frames[next].frame == solved.frame) solved.simulated = frames[next].exposure;
    }
}

}  // namespace matchlight
