// matchlight probe panorama: photographs of all directions, or one linear picture of them, as a probe.
#include <filesystem>
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/linear_light.h"
#include "commands/photograph_options.h"
#include "commands/probe_commands.h"
#include "commands/probe_output.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "lighting/panorama.h"
#include "lighting/probe_file.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct PanoramaCall {
    std::vector<fs::path> pictures;
    LightOptions light;
    ProbeOutput output;
};

void run_panorama(const PanoramaCall& call, CommandContext& context) {
    check_not_an_input(call.output.path, call.pictures);
    check_output(call.output.path, call.output.overwrite);
    require_probe_extension(call.output.path);
    const Eigen::Matrix3d turn = world_from_picture(call.output);
    const OutputLock lock(call.output.path);
    LinearLight read = read_light(call.pictures, call.light, context.warnings);
    if (!is_panorama_shape(read.light.width(), read.light.height())) {
        throw InputError(call.pictures.front(),
                         fmt::format("{} × {} pixels are no panorama of all directions, which is twice as wide as high",
                                     read.light.width(), read.light.height()),
                         "export it as equirectangular, 360° × 180°, with the unseen parts black");
    }
    for (float& sample : read.light.samples()) sample = static_cast<float>(sample * read.exposure);
    const int height = wanted_latlong_height(call.output, read.light.height());
    const StitchedSphere sphere = panorama_sphere(read.light, read.clipped, turn, height);
    ImageMetadata metadata = {{"source", read.sources}, {"exposure_scale", fmt::format("{}", read.exposure)}};
    json result = write_sphere(call.output, sphere, metadata, context.warnings);
    result["clipped_pixels"] = read.clipped_pixels;
    result["exposure_scale"] = read.exposure;
    print_result(context, result, sphere_text(result));
}

}  // namespace

void add_probe_panorama_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command =
        probe.add_subcommand("panorama", "A probe from a panorama of all directions, bracketed or linear");
    const auto call = std::make_shared<PanoramaCall>();
    // Shifting a panorama's pixels is no turn of the camera, and seams would show.
    call->light.align = Alignment::off;
    command
        ->add_option("PICTURES", call->pictures,
                     "Equirectangular photographs, twice as wide as high, exposed differently; or one .exr or .hdr")
        ->required();
    add_probe_output_options(*command, call->output);
    add_light_options(*command, call->light);
    command->callback([call, &context] { run_panorama(*call, context); });
}

}  // namespace matchlight
