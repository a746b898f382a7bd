// matchlight probe fisheye: one or two round pictures of fisheye lenses as a probe.
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibration/camera.h"
#include "commands/linear_light.h"
#include "commands/photograph_options.h"
#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/probe_output.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "lighting/fisheye_circle.h"
#include "lighting/fisheye_pair.h"
#include "lighting/probe_file.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double degree = std::numbers::pi / 180;

struct FisheyeCall {
    std::vector<fs::path> front, back, cameras;
    bool side_by_side = false, no_turn = false, no_gain = false;
    double fov_deg = 0;
    FisheyeProjection model = FisheyeProjection::equidistant;
    std::vector<std::vector<double>> circles;
    std::vector<double> upright_deg = {0, 0};
    LightOptions light;
    ProbeOutput output;
};

const std::map<std::string, FisheyeProjection>& models_by_name() {
    static const std::map<std::string, FisheyeProjection> names = {{"equidistant", FisheyeProjection::equidistant},
                                                                   {"equisolid", FisheyeProjection::equisolid},
                                                                   {"orthographic", FisheyeProjection::orthographic},
                                                                   {"stereographic", FisheyeProjection::stereographic}};
    return names;
}

/// A round picture where it lies in what was read.
struct RoundPicture {
    std::size_t number = 0;  // 0 front, 1 back
    fs::path name;           // for messages
    const LinearLight* read = nullptr;
    Region region;
};

/// What the user said for this picture, of one for both or one for each.
template <class Value>
const Value& one_of(const std::vector<Value>& given, std::size_t number) {
    return given[std::min(number, given.size() - 1)];
}

FisheyeLens lens_of_camera(const FisheyeCall& call, const RoundPicture& picture) {
    const fs::path& path = one_of(call.cameras, picture.number);
    const Camera camera = camera_for_size(load_camera(path), picture.region.width, picture.region.height, path);
    if (camera.lens != LensModel::fisheye) {
        throw InputError(path, "is no fisheye lens", "calibrate with --model fisheye, or give --model and --fov-deg");
    }
    FisheyeLens lens;
    lens.projection = FisheyeProjection::kannala_brandt;
    lens.centre_px = {picture.region.x + camera.cx, picture.region.y + camera.cy};
    lens.focal_px = {camera.fx, camera.fy};
    for (std::size_t i = 0; i < std::min(lens.k.size(), camera.distortion.size()); ++i)
        lens.k[i] = camera.distortion[i];
    lens.most_angle = call.fov_deg * degree / 2;
    return lens;
}

PixelCircle circle_of(const FisheyeCall& call, const RoundPicture& picture) {
    if (!call.circles.empty()) {
        const std::vector<double>& given = one_of(call.circles, picture.number);
        const PixelCircle circle{{given[0], given[1]}, given[2]};
        const Region& region = picture.region;
        const bool inside = circle.centre_px.x() > region.x && circle.centre_px.x() < region.x + region.width &&
                            circle.centre_px.y() > region.y && circle.centre_px.y() < region.y + region.height;
        if (!inside || !(circle.radius_px >= 8 && circle.radius_px <= 4.0 * std::max(region.width, region.height))) {
            throw InputError(
                picture.name,
                fmt::format("the circle {},{},{} does not lie in the picture", given[0], given[1], given[2]),
                "give the middle and the radius in pixels");
        }
        return circle;
    }
    const std::optional<PixelCircle> found = find_fisheye_circle(picture.read->light, picture.region);
    if (!found) {
        throw InputError(picture.name, "no round picture on a dark frame was found",
                         "give it by hand: --circle X,Y,RADIUS");
    }
    return *found;
}

FisheyePicture fisheye_of(const FisheyeCall& call, const RoundPicture& picture) {
    FisheyePicture fisheye{picture.read->light, {}, one_of(call.upright_deg, picture.number), picture.read->clipped};
    fisheye.lens = call.cameras.empty() ? lens_of_circle(call.model, circle_of(call, picture), call.fov_deg * degree)
                                        : lens_of_camera(call, picture);
    const double widest = widest_angle(fisheye.lens);
    if (fisheye.lens.most_angle > widest + 1e-9) {
        throw InputError(
            picture.name,
            fmt::format("a lens of this kind sees {:.1f}° at most, not {}°", 2 * widest / degree, call.fov_deg),
            "lower --fov-deg, or name another --model");
    }
    return fisheye;
}

json circle_json(const FisheyePicture& picture) {
    const FisheyeLens& lens = picture.lens;
    return {{"centre_px", {lens.centre_px.x(), lens.centre_px.y()}},
            {"radius_px", lens.focal_px.mean() * lens.radius_of(lens.most_angle)},
            {"focal_px", {lens.focal_px.x(), lens.focal_px.y()}}};
}

json match_json(const PairMatch& match) {
    json gain = json::array(), turn = json::array();
    for (int c = 0; c < 3; ++c) {
        gain.push_back(std::log2(match.back_gain[c]));
        turn.push_back(match.turn_rad[c] / degree);
    }
    return {{"overlap_deg", match.overlap_deg},
            {"turned", match.turned},
            {"turn_deg", turn},
            {"back_gain_ev", gain},
            {"difference_ev", match.difference_ev},
            {"difference_before_ev", match.difference_before_ev}};
}

std::string match_text(const PairMatch& match) {
    if (match.overlap_deg < 1) return "the halves do not overlap enough to be matched\n";
    std::string text = fmt::format("seen by both: a ring of {:.1f}°, where they differ by {:.3f} EV", match.overlap_deg,
                                   match.difference_ev);
    text += match.turned ? fmt::format(" ({:.3f} before the back was turned by {:.2f}°)", match.difference_before_ev,
                                       match.turn_rad.norm() / degree)
                         : std::string(", the back as it stands");
    return text + fmt::format("; the back's light × {:.3f} {:.3f} {:.3f}\n", match.back_gain[0], match.back_gain[1],
                              match.back_gain[2]);
}

/// The two halves of a picture that holds both circles.
std::array<Region, 2> halves_of(const ImageF& light) {
    const int width = light.width(), height = light.height();
    if (width >= height) return {{{0, 0, width / 2, height}, {width / 2, 0, width - width / 2, height}}};
    return {{{0, 0, width, height / 2}, {0, height / 2, width, height - height / 2}}};
}

void check_call(const FisheyeCall& call) {
    if (call.side_by_side && !call.back.empty()) {
        throw CLI::ValidationError("--side-by-side", "means that both are in one picture, which needs no --back");
    }
    std::vector<fs::path> inputs = call.front;
    inputs.insert(inputs.end(), call.back.begin(), call.back.end());
    check_not_an_input(call.output.path, inputs);
    check_output(call.output.path, call.output.overwrite);
    require_probe_extension(call.output.path);
}

void run_fisheye(const FisheyeCall& call, CommandContext& context) {
    check_call(call);
    const Eigen::Matrix3d turn = world_from_picture(call.output);
    const OutputLock lock(call.output.path);

    LinearLight front_light = read_light(call.front, call.light, context.warnings), back_light;
    std::vector<RoundPicture> pictures = {{0, call.front.front(), &front_light, front_light.light.bounds()}};
    if (call.side_by_side) {
        const std::array<Region, 2> halves = halves_of(front_light.light);
        pictures[0].region = halves[0];
        pictures.push_back({1, call.front.front(), &front_light, halves[1]});
    } else if (!call.back.empty()) {
        back_light = read_light(call.back, call.light, context.warnings);
        pictures.push_back({1, call.back.front(), &back_light, back_light.light.bounds()});
    }
    // In units of the front's reference photograph, the back's, too, so that one exposure of both is one.
    for (ImageF* light : {&front_light.light, &back_light.light}) {
        for (float& sample : light->samples()) sample = static_cast<float>(sample * front_light.exposure);
    }
    std::vector<FisheyePicture> fisheyes;
    for (const RoundPicture& picture : pictures) fisheyes.push_back(fisheye_of(call, picture));
    MatchOptions matching;
    matching.turn = !call.no_turn;
    matching.gain = !call.no_gain;
    const bool pair = fisheyes.size() == 2;
    const PairMatch match = pair ? match_pair(fisheyes[0], fisheyes[1], matching) : PairMatch{};
    const StitchedSphere sphere = stitched_pair(fisheyes[0], pair ? &fisheyes[1] : nullptr, match, turn,
                                                wanted_latlong_height(call.output, latlong_height_for(fisheyes[0])));

    ImageMetadata metadata = {
        {"source", front_light.sources + (back_light.sources.empty() ? "" : "; " + back_light.sources)},
        {"exposure_scale", fmt::format("{}", front_light.exposure)}};
    json result = write_sphere(call.output, sphere, metadata, context.warnings);
    result["clipped_pixels"] = front_light.clipped_pixels + back_light.clipped_pixels;
    result["exposure_scale"] = front_light.exposure;
    std::string text = sphere_text(result);
    for (const FisheyePicture& fisheye : fisheyes) {
        const json circle = circle_json(fisheye);
        text += fmt::format("circle at ({:.1f}, {:.1f}), radius {:.1f} px\n", fisheye.lens.centre_px.x(),
                            fisheye.lens.centre_px.y(), circle["radius_px"].get<double>());
        result["circles"].push_back(circle);
    }
    if (pair) {
        result["match"] = match_json(match);
        text += match_text(match);
    }
    print_result(context, result, text);
}

/// "x,y,radius".
std::string read_circle(const std::string& text, std::vector<std::vector<double>>& circles) {
    std::vector<double> numbers;
    for (const std::string& part : CLI::detail::split(text, ',')) {
        double value = 0;
        if (!CLI::detail::lexical_cast(part, value) || !std::isfinite(value))
            return "'" + text + "' is no circle X,Y,RADIUS";
        numbers.push_back(value);
    }
    if (numbers.size() != 3) return "'" + text + "' is no circle X,Y,RADIUS";
    circles.push_back(numbers);
    return {};
}

}  // namespace

void add_probe_fisheye_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command =
        probe.add_subcommand("fisheye", "A probe from round pictures of fisheye lenses, one or two back to back");
    const auto call = std::make_shared<FisheyeCall>();
    command
        ->add_option("FRONT", call->front,
                     "Photographs through the lens that looks forward, exposed differently; or one .exr or .hdr")
        ->required();
    command->add_option("--back", call->back, "The same through the lens that looks backwards")->type_name("PICTURES");
    command->add_flag("--side-by-side", call->side_by_side,
                      "Both circles are in one picture: the front's on the left, or on top in a tall one");
    command->add_option("--fov-deg", call->fov_deg, "Angle of view across the circle, such as 190")
        ->required()
        ->check(CLI::Validator(
            [](const std::string& text) {
                double value = 0;
                const bool fine = CLI::detail::lexical_cast(text, value) && value >= 20 && value <= 360;
                return fine ? std::string() : "'" + text + "' is not between 20 and 360";
            },
            ""))
        ->type_name("DEGREES");
    command->add_option("--model", call->model, "equidistant (default), equisolid, orthographic, stereographic")
        ->transform(CLI::CheckedTransformer(models_by_name()).description(""))
        ->type_name("MODEL");
    command
        ->add_option("--camera", call->cameras,
                     "The calibrated lens (`calibrate --model fisheye`) in place of --model; one for both, or one each")
        ->expected(1, 2)
        ->type_name("FILE");
    command
        ->add_option_function<std::vector<std::string>>(
            "--circle",
            [call](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) {
                    const std::string wrong = read_circle(text, call->circles);
                    if (!wrong.empty()) throw CLI::ValidationError("--circle", wrong);
                }
            },
            "The round picture's middle and radius in pixels (default: found); one for both, or one each")
        ->expected(1, 2)
        ->type_name("X,Y,RADIUS");
    command
        ->add_option("--upright-deg", call->upright_deg,
                     "Turn the front's (and the back's) picture clockwise by so much to make it upright")
        ->delimiter(',')
        ->expected(1, 2)
        ->check(within(3600))
        ->type_name("DEGREES");
    command->add_flag("--no-turn", call->no_turn, "Leave the back as it stands, do not turn it until both agree");
    command->add_flag("--no-gain", call->no_gain, "Leave the back as bright as it is");
    add_probe_output_options(*command, call->output);
    add_light_options(*command, call->light);
    command->callback([call, &context] { run_fisheye(*call, context); });
}

}  // namespace matchlight
