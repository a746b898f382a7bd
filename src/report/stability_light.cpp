// Cases on the GPU: environment maps, shadows, bright light and what it spills.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "core/warnings.h"
#include "gl/framebuffer.h"
#include "render/effects/bloom.h"
#include "render/effects/bright_pass.h"
#include "render/effects/contact_shadow.h"
#include "render/effects/streaks.h"
#include "render/environment.h"
#include "report/effect_stage.h"
#include "report/reflected_picture.h"
#include "report/scratch_probe.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

constexpr double largest_half = 65504;
/// Half a step of a half float at 1, and its least step near 0.
constexpr double half_step = 0x1p-11, least_half = 0x1p-24;
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

/// Reflected light in every direction, RGB over a lat-long picture.
ImageF reflected(const Environment& environment, double roughness, bool sphere_map) {
    ShaderLibrary shaders;
    const ReflectedPicture picture(128);
    picture.draw(shaders, environment, roughness, sphere_map);
    return picture.read();
}

Environment environment_of(const Probe& probe) {
    ShaderLibrary shaders;
    return Environment(shaders, probe, {.face_size = 64, .sphere_map_size = 128, .lookups_per_level = 20'000});
}

void add_environment_cases(std::vector<StabilityCase>& cases) {
    struct Form {
        const char* name;
        double roughness;
        bool sphere_map;
    };
    // A sphere map's rim is the one direction away from the eye: a lat-long picture's middle row passes through it.
    constexpr Form forms[] = {{"mirror of the cube map", 0, false},
                              {"roughness 0.5 of the cube map", 0.5, false},
                              {"the whole sphere map, its pole included", 0, true}};
    for (const Form& form : forms) {
        for (const double radiance : {0.0, 1e-8, 1.0, largest_half, 1e9}) {
            cases.push_back({"environment",
                             fmt::format("{}, even light of {:g}", form.name, radiance),
                             "largest error over what half floats may lose",
                             {0, 1},
                             {},
                             [form, radiance] {
                                 const Probe probe{ImageF(64, 32, 3, static_cast<float>(radiance))};
                                 const double expected = std::min(radiance, largest_half);
                                 // Two roundings to half floats on the way: the probe's and the map's.
                                 const double bound = 4 * (half_step * expected + least_half);
                                 double worst = 0;
                                 const ImageF seen = reflected(environment_of(probe), form.roughness, form.sphere_map);
                                 for (const float value : seen.samples()) {
                                     const double error = std::abs(value - expected) / bound;
                                     worst = std::isfinite(error) ? std::max(worst, error) : infinite;
                                 }
                                 return StabilityOutcome{worst, {}};
                             }});
        }
        cases.push_back({"environment",
                         fmt::format("{}, a one-pixel sun of 1e9 over walls of 0.1", form.name),
                         "largest light",
                         {0.09, largest_half},
                         {},
                         [form] {
                             Probe probe{ImageF(256, 128, 3, 0.1F)};
                             for (int c = 0; c < 3; ++c) probe.latlong.at(100, 40, c) = 1e9F;
                             double largest = 0;
                             const ImageF seen = reflected(environment_of(probe), form.roughness, form.sphere_map);
                             for (const float value : seen.samples()) {
                                 largest =
                                     std::isfinite(value) ? std::max(largest, static_cast<double>(value)) : infinite;
                             }
                             return StabilityOutcome{largest, {}};
                         }});
    }
}

void add_probe_cases(std::vector<StabilityCase>& cases) {
    struct Damage {
        const char* name;
        float value;
    };
    for (const Damage& damage : {Damage{"NaN", not_a_number}, Damage{"infinity", infinite},
                                 Damage{"-infinity", -infinite}, Damage{"-1", -1.0F}}) {
        cases.push_back({"probe file",
                         fmt::format("a pixel of {}", damage.name),
                         "samples that are no light",
                         {0, 0},
                         {},
                         [damage] {
                             ImageF light(64, 32, 3, 0.5F);
                             light.at(20, 10, 1) = damage.value;
                             const ScratchProbe file(light);
                             Warnings warnings;
                             warnings.set_quiet(true);
                             const Probe probe = load_probe(file.path(), ProbeMapping::latlong, warnings);
                             double bad = warnings.empty() ? 1 : 0;  // it must be told
                             for (const float value : probe.latlong.samples()) {
                                 bad += std::isfinite(value) && value >= 0 ? 0 : 1;
                             }
                             return StabilityOutcome{bad, {}};
                         }});
    }
}

/// A box of 2 cm on the surface as a caster.
class BoxCaster {
public:
    BoxCaster() {
        std::vector<float> positions;
        std::vector<std::uint32_t> indices;
        for (int i = 0; i < 8; ++i) {
            for (const int bit : {1, 2, 4}) positions.push_back((i & bit) != 0 ? 0.02F : (bit == 4 ? 0.0F : -0.02F));
        }
        for (const std::uint32_t i : {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                      2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5}) {
            indices.push_back(i);
        }
        vertices_ = Buffer(std::span<const float>(positions));
        indices_ = Buffer(std::span<const std::uint32_t>(indices));
        const VertexArray::Attribute position{.location = 0, .components = 3};
        array_.set_vertex_buffer(0, vertices_, 3 * sizeof(float), {&position, 1});
        array_.set_index_buffer(indices_);
        count_ = static_cast<GLsizei>(indices.size());
    }

    ShadowCasters casters() const {
        return {{Eigen::Vector3d(-0.02, -0.02, 0), Eigen::Vector3d(0.02, 0.02, 0.02)}, [this](Program& program) {
                    program.set("world_from_model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
                    array_.bind();
                    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
                }};
    }

private:
    Buffer vertices_, indices_;
    VertexArray array_;
    GLsizei count_ = 0;
};

void add_shadow_cases(std::vector<StabilityCase>& cases) {
    struct Light {
        const char* name;
        double walls, sun;
    };
    for (const Light& light : {Light{"black light", 0, 0}, Light{"even light of 1e-8", 1e-8, 1e-8},
                               Light{"even light of 65504", largest_half, largest_half},
                               Light{"even light of 1e9", 1e9, 1e9}, Light{"a one-pixel sun of 1e9 alone", 0, 1e9},
                               Light{"a one-pixel sun of 1e9 over walls of 1e-8", 1e-8, 1e9}}) {
        cases.push_back({"contact shadow",
                         fmt::format("under {}", light.name),
                         "largest share of the light lost",
                         {0, 1.00001},
                         {},
                         [light] {
                             Probe probe{ImageF(256, 128, 3, static_cast<float>(light.walls))};
                             for (int c = 0; c < 3; ++c) probe.latlong.at(100, 30, c) = static_cast<float>(light.sun);
                             ShaderLibrary shaders;
                             const BoxCaster box;
                             const auto shadow =
                                 make_contact_shadow(shaders, box.casters(), make_surface_light(probe, 0, 64),
                                                     {.directions = 64, .resolution = 128});
                             if (!shadow) return StabilityOutcome{0, {}};
                             double largest = 0;
                             for (const ShadowMap* map : {&shadow->fine, &shadow->far}) {
                                 const ImageF lost = map->loss.read<float>(map->loss.bounds(), 3);
                                 for (const float value : lost.samples()) {
                                     largest = value >= 0 ? std::max(largest, static_cast<double>(value)) : infinite;
                                 }
                             }
                             return StabilityOutcome{largest, {}};
                         }});
    }
}

FrameLightImages one_bright_pixel(int width, int height, float light) {
    FrameLightImages images;
    images.after = ImageF(width, height, 4);
    images.region = {0, 0, width, height};
    images.frame_width = width;
    images.frame_height = height;
    for (int c = 0; c < 3; ++c) images.after.at(width / 2, height / 2, c) = light;
    images.after.at(width / 2, height / 2, 3) = 1;
    return images;
}

}  // namespace

std::vector<StabilityCase> spill_cases(const std::string& effect, const SpillCaseBounds& bounds, const AddSpill& add) {
    std::vector<StabilityCase> cases;
    const auto run = [add](const FrameLightImages& light, float pixel) {
        EffectStage stage(light);
        ShaderLibrary shaders;
        stage.draw([&](RenderGraph& graph, const FrameLight& frame, GpuCondition& bright) {
            return add(graph, shaders, frame, bright);
        });
        StabilityOutcome outcome{0, {}};
        const ImageF added = stage.added();
        for (const float value : added.samples()) {
            const double size = std::abs(static_cast<double>(value));
            outcome.value = std::isfinite(value) ? std::max(outcome.value, size) : infinite;
        }
        if (pixel > 0 && std::isfinite(pixel)) outcome.energy_kept = stage.energy() / pixel;
        return outcome;
    };
    struct Light {
        const char* name;
        float value;
        bool keeps_energy;
    };
    for (const Light& light : {Light{"0", 0, false}, Light{"1e-8", 1e-8F, false}, Light{"1", 1, true},
                               Light{"1000", 1000, true}, Light{"65504", 65504, true}, Light{"1e9", 1e9F, false},
                               Light{"infinity", infinite, false}, Light{"NaN", not_a_number, false}}) {
        cases.push_back({effect,
                         fmt::format("one pixel of {} in 201×151", light.name),
                         "largest light added",
                         {0, largest_half},
                         light.keeps_energy ? bounds.energy : std::nullopt,
                         [run, light] { return run(one_bright_pixel(201, 151, light.value), light.value); }});
    }
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}}) {
        cases.push_back({effect,
                         fmt::format("a frame of {}×{} filled with 1000", width, height),
                         "largest light added",
                         {0, bounds.most_gain * 1000},
                         {},
                         [run, width = width, height = height] {
                             FrameLightImages light = one_bright_pixel(width, height, 1000);
                             std::ranges::fill(light.after.samples(), 1000.0F);
                             for (int y = 0; y < height; ++y) {
                                 for (int x = 0; x < width; ++x) light.after.at(x, y, 3) = 1;
                             }
                             return run(light, 0);
                         }});
    }
    if (bounds.huge_frames) {
        cases.push_back({effect,
                         "the last pixel of 8192×4320 at 1000",
                         "largest light added",
                         {0, bounds.most_gain * 1000},
                         {},
                         [run] {
                             FrameLightImages light = one_bright_pixel(1, 1, 1000);
                             light.region = {8191, 4319, 1, 1};
                             light.frame_width = 8192;
                             light.frame_height = 4320;
                             return run(light, 0);
                         }});
    }
    return cases;
}

namespace {

void add_bloom_cases(std::vector<StabilityCase>& cases) {
    struct Level {
        const char* name;
        BloomLevel level;
        double least_energy;
    };
    // What lies beyond three standard deviations of two axes is 0.5 % of a Gaussian; the frame holds the rest. The
    // finest square of the classic model is finer than the frame here: pixels sample it with gaps.
    for (const auto& [name, level, least_energy] :
         {Level{"bloom, pyramid", BloomLevel::pyramid, 0.994}, Level{"bloom, classic", BloomLevel::classic, 0.99},
          Level{"bloom, reference", BloomLevel::reference, 0.994}}) {
        const BloomSettings settings{
            .level = level, .threshold = 0, .knee = 0, .strength = 1, .radius = 0.03, .firefly_safe = false};
        const AddSpill bloom = [settings](RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                                          GpuCondition& bright) {
            return add_bloom(graph, shaders, light, settings, bloom_knobs(settings, QualityLevel::final_), 1, bright);
        };
        for (StabilityCase& one :
             spill_cases(name, {.energy = Bound{least_energy, 1.002}, .huge_frames = true}, bloom)) {
            cases.push_back(std::move(one));
        }
    }
}

void add_streak_cases(std::vector<StabilityCase>& cases) {
    const auto streaks_of = [](const GlareSettings& settings) -> AddSpill {
        return [settings](RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light, GpuCondition& bright) {
            return add_streaks(graph, shaders, light, settings, streak_knobs(QualityLevel::final_), {}, bright);
        };
    };
    for (const auto& [name, level] :
         {std::pair{"streaks", GlareLevel::streaks}, {"streaks, classic", GlareLevel::classic}}) {
        const GlareSettings settings{.level = level, .threshold = 0, .knee = 0, .strength = 1, .passes = 2};
        // A lone pixel is held back as a firefly, by design: its energy is bounded below, at light of 1.
        for (StabilityCase& one : spill_cases(name, {.energy = {}, .huge_frames = true}, streaks_of(settings))) {
            cases.push_back(std::move(one));
        }
    }
    for (const double attenuation : {0.9, 0.99, 0.999}) {
        const GlareSettings settings{.threshold = 0, .knee = 0, .strength = 1, .attenuation = attenuation, .passes = 3};
        cases.push_back({"streaks",
                         fmt::format("a = {:g}, one pixel of 1 in 401×301", attenuation),
                         "largest light added",
                         {0, 1},
                         // Half floats of a long faint line, and a thousandth that is held back as a firefly.
                         Bound{0.985, 1.005},
                         [streaks = streaks_of(settings)] {
                             EffectStage stage(one_bright_pixel(401, 301, 1));
                             ShaderLibrary shaders;
                             stage.draw([&](RenderGraph& graph, const FrameLight& frame, GpuCondition& bright) {
                                 return streaks(graph, shaders, frame, bright);
                             });
                             double largest = 0;
                             const ImageF added = stage.added();
                             for (const float value : added.samples()) {
                                 largest = std::isfinite(value)
                                               ? std::max(largest, std::abs(static_cast<double>(value)))
                                               : infinite;
                             }
                             return StabilityOutcome{largest, stage.energy()};
                         }});
    }
}

}  // namespace

std::vector<StabilityCase> light_cases() {
    std::vector<StabilityCase> cases;
    add_environment_cases(cases);
    add_probe_cases(cases);
    add_shadow_cases(cases);
    const AddSpill bright_pass = [](RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                                    GpuCondition& bright) {
        return add_bright_pass(graph, shaders, light, {.threshold = 0, .knee = 0}, 4, bright);
    };
    // Half floats of a sixteenth of the light; every pixel is in one texel.
    for (StabilityCase& one :
         spill_cases("bright pass", {.energy = Bound{0.999, 1.001}, .huge_frames = true}, bright_pass)) {
        cases.push_back(std::move(one));
    }
    add_bloom_cases(cases);
    add_streak_cases(cases);
    return cases;
}

}  // namespace matchlight
