// Compares the effective settings that a solve recorded with the scene's, section by section.
#include "tracking/solve_freshness.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "tracking/lens_projection.h"
#include "tracking/plate_light.h"

namespace matchlight {
namespace {

/// The lines of `[section]` in an effective scene text whose keys `counts` accepts.
std::string section_of(const std::string& effective_toml, std::string_view section, bool (*counts)(std::string_view)) {
    std::istringstream text(effective_toml);
    std::string lines;
    bool inside = false;
    for (std::string line; std::getline(text, line);) {
        if (line.starts_with('[')) inside = line == "[" + std::string(section) + "]";
        if (inside && counts(std::string_view(line).substr(0, line.find(' ')))) lines += line + "\n";
    }
    return lines;
}

bool any_key(std::string_view) {
    return true;
}
bool is_albedo_key(std::string_view key) {
    return key == "white_albedo" || key == "black_albedo";
}
bool is_response_key(std::string_view key) {
    return key == "response";
}
bool is_footage_name(std::string_view key) {
    return key == "video";
}
/// Camera and response are compared by what is in their files.
bool is_other_footage_key(std::string_view key) {
    return key == "color_matrix" || key == "color_range" || key == "fps" || key == "refine_lens" || key == "readout" ||
           key == "ocio_space";
}

/// A tag that the solve does not hold, or whose place the scene does not give, contradicts nothing.
bool contradicts(const RigTag& tag, const std::vector<SolvedTag>& rig) {
    // Settings are kept to the last bits of a double; a micrometre is far above those and below any ruler.
    constexpr double tolerance_m = 1e-6;
    constexpr double tolerance_of_rotation = 1e-6;
    for (const SolvedTag& solved : rig) {
        if (solved.id != tag.id) continue;
        if (std::abs(solved.size_m - tag.size_m) > tolerance_m) return true;
        if (!tag.world_from_tag) return false;
        const Eigen::Matrix4d difference = tag.world_from_tag->matrix() - solved.world_from_tag.matrix();
        return difference.topRightCorner<3, 1>().cwiseAbs().maxCoeff() > tolerance_m ||
               difference.topLeftCorner<3, 3>().cwiseAbs().maxCoeff() > tolerance_of_rotation;
    }
    return false;
}

/// The scene's lens, but for what the clip refined of it.
bool same_camera(const Camera& scene, const Solve& solve) {
    LensVector expected = lens_vector(scene);
    const LensVector solved = lens_vector(solve.camera);
    for (const LensParameter& parameter : solve.lens_parameters) {
        const auto name = std::ranges::find(lens_parameter_names, parameter.name);
        if (!parameter.refined || name == lens_parameter_names.end()) continue;
        const auto i = name - lens_parameter_names.begin();
        expected[i] = solved[i];
    }
    const Camera a = camera_with(scene, expected);
    const Camera& b = solve.camera;
    return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
           a.lens == b.lens && a.distortion == b.distortion;
}

/// Equal at every code of ten bits, to what JSON and a float keep of a number. Footage that says PQ or HLG has that
/// response, whatever the scene names.
bool same_response(const Response& scene, const Response& solve) {
    if (solve.family() == Response::Family::pq || solve.family() == Response::Family::hlg) return true;
    for (int channel = 0; channel < 3; ++channel) {
        const std::vector<float> a = scene.sampled_linear(1024, channel);
        const std::vector<float> b = solve.sampled_linear(1024, channel);
        for (std::size_t i = 0; i < a.size(); ++i) {
            if (std::abs(a[i] - b[i]) > 1e-6f * std::max(1.0f, std::abs(a[i]))) return false;
        }
    }
    return true;
}

}  // namespace

void check_solve_is_of_scene(const Solve& solve, const Scene& scene, Warnings& warnings) {
    if (!solve.provenance.starts_with("matchlight ")) return;
    const std::filesystem::path& path = scene.footage.solve;
    const auto differs = [&](std::string_view section, bool (*counts)(std::string_view)) {
        return section_of(solve.provenance, section, counts) != section_of(scene.effective_toml, section, counts);
    };
    const auto refuse = [&](const std::string& what) {
        throw InputError(path, "was made with " + what, "run: matchlight track " + scene.path.string());
    };
    for (const RigTag& tag : scene.tags.rig) {
        if (contradicts(tag, solve.rig))
            refuse("another size or place of tag " + std::to_string(tag.id) + " in [tags]");
    }
    if (differs("footage", is_other_footage_key)) refuse("other settings of [footage] than the scene has");

    if (!scene.footage.camera.empty()) {
        const Camera camera = camera_for_size(load_camera(scene.footage.camera), solve.camera.width,
                                              solve.camera.height, scene.footage.camera);
        if (!same_camera(camera, solve)) refuse("another camera than " + scene.footage.camera.string());
    }

    if (scene.footage.solve_response) {
        if (differs("footage", is_response_key)) refuse("a response that was not solved for, as the scene asks");
    } else {
        const Response response = footage_response(scene.footage);
        if (!same_response(response, solve.response)) refuse("another response than the scene has");
    }

    const std::string cure = "; to follow the change run: matchlight track " + scene.path.string();
    if (differs("light", any_key) || differs("tags", is_albedo_key))
        warnings.add(path.string() + ": was made with another light or grey card" + cure);
    if (differs("footage", is_footage_name)) warnings.add(path.string() + ": was made from another video" + cure);
}

}  // namespace matchlight
