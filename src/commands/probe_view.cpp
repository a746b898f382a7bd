// matchlight probe view: what a light probe does to a row of balls.
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/probe_ball_row.h"
#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/result.h"
#include "compositor/quality.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"
#include "gl/context.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

struct ProbeViewOptions {
    BallRowOptions row;
    fs::path output;
    bool overwrite = false;
};

void run_view(const ProbeViewOptions& options, CommandContext& context) {
    const fs::path extension = options.output.extension();
    if (extension != ".png" && extension != ".exr") {
        throw InputError(options.output, "views are written as .png or .exr",
                         "name view.png, or view.exr for its light");
    }
    std::error_code error;
    if (fs::equivalent(options.row.probe, options.output, error)) {
        throw InputError(options.output, "the output is the input", "give another name");
    }
    check_output(options.output, options.overwrite);
    const OutputLock lock(options.output);
    const auto gl = create_offscreen_context();
    const BallRow drawn = draw_ball_row(*gl, options.row, context.warnings);

    const ImageMetadata metadata = {{"software", std::string("matchlight ") + version},
                                    {"source", options.row.probe.filename().string()},
                                    {"exposure_ev", fmt::format("{}", drawn.exposure_ev)}};
    if (extension == ".exr") {
        write_exr(options.output, drawn.light.width(), drawn.light.height(),
                  {{.name = "", .channels = {"R", "G", "B"}, .image = &drawn.light, .half = true, .data_window = {}}},
                  metadata);
    } else {
        write_png8(options.output, drawn.picture, metadata);
    }
    print_result(context,
                 {{"file", options.output.string()},
                  {"width", drawn.picture.width()},
                  {"height", drawn.picture.height()},
                  {"exposure_ev", drawn.exposure_ev}},
                 fmt::format("{}: {} x {} pixels at {:+.2f} EV", options.output.string(), drawn.picture.width(),
                             drawn.picture.height(), drawn.exposure_ev));
}

}  // namespace

void add_probe_view_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command = probe.add_subcommand(
        "view",
        "A picture of five balls in its light: matte grey, chrome, metal of roughness 0.2 and 0.5, white "
        "plastic; above with the probe behind them, below on grey ground");
    const auto options = std::make_shared<ProbeViewOptions>();
    command->add_option("PROBE", options->row.probe, "An .exr or .hdr image of all directions")->required();
    command->add_option("-o,--output", options->output, "Where to write: .png, or .exr for linear light")->required();
    add_from_option(*command, options->row.mapping);
    command
        ->add_option("--azimuth-deg", options->row.azimuth_deg,
                     "Where the camera looks, counter-clockwise from world +x (default 90: forward, +y)")
        ->check(within(3600))
        ->type_name("DEGREES");
    command->add_option("--elevation-deg", options->row.elevation_deg, "Of the camera above the balls (default 8)")
        ->check(within(89))
        ->type_name("DEGREES");
    command
        ->add_option("--exposure-ev", options->row.exposure_ev,
                     "Instead of the exposure that shows the grey ball's bright side at 60 % of white")
        ->check(within(64))
        ->type_name("EV");
    command->add_option("--size", options->row.ball_px, "Diameter of a ball in pixels (default 192)")
        ->check(CLI::Range(16, 1024).description(""))
        ->type_name("PIXELS");
    command->add_option("--level", options->row.quality, "draft, preview, final (default) or reference")
        ->transform(
            CLI::CheckedTransformer(std::map<std::string, QualityLevel>(quality_levels.begin(), quality_levels.end()))
                .description(""))
        ->type_name("LEVEL");
    command->add_flag("--overwrite", options->overwrite, "Replace a file that exists");
    command->callback([options, &context] { run_view(*options, context); });
}

}  // namespace matchlight
