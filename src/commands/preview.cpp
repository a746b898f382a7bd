// `matchlight preview`: the window on a scene; or, for scripts, a picture of what it shows.
#include "preview/preview.h"

#include <charconv>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "commands/command.h"
#include "commands/result.h"
#include "compositor/quality.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "preview/script.h"

namespace matchlight {

namespace {

struct PreviewArguments {
    PreviewOptions options;
    std::string scene;
    std::string size;
    std::string keys;
    std::string snapshot;
    std::string script;
    std::string truth;
    bool overwrite = false;
};

/// "1280x720"; nullopt for anything else.
std::optional<Eigen::Vector2i> parse_size(const std::string& text) {
    constexpr int largest = 16384;  // of textures, on most machines
    Eigen::Vector2i size(0, 0);
    const char* const end = text.data() + text.size();
    const auto width = std::from_chars(text.data(), end, size.x());
    if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') return std::nullopt;
    const auto height = std::from_chars(width.ptr + 1, end, size.y());
    if (height.ec != std::errc() || height.ptr != end) return std::nullopt;
    if (size.minCoeff() < 1 || size.maxCoeff() > largest) return std::nullopt;
    return size;
}

void preview(PreviewArguments arguments, CommandContext& context) {
    PreviewOptions& options = arguments.options;
    options.scene = arguments.scene;
    options.snapshot = arguments.snapshot;
    options.script = arguments.script;
    options.truth = arguments.truth;
    options.overwrite = arguments.overwrite;
    options.quiet = context.quiet;
    options.keys = actions_of_keys(arguments.keys);
    if (!arguments.size.empty()) options.size = parse_size(arguments.size);
    if (!options.snapshot.empty()) {
        if (options.snapshot.extension() != ".png") {
            throw InputError(options.snapshot, "a snapshot is a PNG picture", "end its name in .png");
        }
        check_output(options.snapshot, arguments.overwrite);
    }
    // The result for programs stays alone on standard output.
    options.print = [stream = context.json ? stderr : stdout](const std::string& text) {
        fmt::print(stream, "{}\n", text);
        std::fflush(stream);
    };
    const PreviewResult shown = run_preview(options, context.warnings);
    if (options.snapshot.empty()) return;
    print_result(context,
                 {{"snapshot", options.snapshot.string()},
                  {"frame", shown.frame},
                  {"time_s", shown.time_s},
                  {"width", shown.window_px.x()},
                  {"height", shown.window_px.y()}},
                 fmt::format("{}: frame {}", options.snapshot.string(), shown.frame));
}

}  // namespace

void add_preview_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("preview", "Show the scene in a window: step, play, switch effects");
    command->footer("Keys:\n" + preview_keys_text() + "\nScripts:\n" + script_help());
    const auto arguments = std::make_shared<PreviewArguments>();
    command->add_option("scene", arguments->scene, "Scene file")->required()->type_name("SCENE.toml");
    command->add_option("--frame", arguments->options.frame, "Show this frame first (0)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("FRAME");
    command->add_option("--level", arguments->options.level, "Quality, instead of the scene's")
        ->transform(
            CLI::CheckedTransformer(std::map<std::string, QualityLevel>(quality_levels.begin(), quality_levels.end())));
    command->add_option("--size", arguments->size, "Of the window; the footage's, fitted to the screen, unless given")
        ->check([](const std::string& text) { return parse_size(text) ? "" : text + " is no size such as 1280x720"; })
        ->type_name("WxH");
    command->add_option("--keys", arguments->keys, "Press these first, such as b,right,right")
        ->check([](const std::string& text) {
            try {
                actions_of_keys(text);
                return std::string();
            } catch (const std::invalid_argument& error) {
                return std::string(error.what());
            }
        })
        ->type_name("KEYS");
    command->add_option("--snapshot", arguments->snapshot, "Save what the window then shows, and quit")
        ->type_name("OUT.png");
    command->add_option("--truth", arguments->truth, "How the scene really looked: a picture, a pattern or a folder")
        ->type_name("PATH");
    command->add_option("--script", arguments->script, "Play these events into the window first, one a line")
        ->type_name("FILE")
        ->excludes("--snapshot");
    command->add_flag("--overwrite", arguments->overwrite, "Replace what exists under the names of pictures");
    command->callback([=, &context] { preview(*arguments, context); });
}

}  // namespace matchlight
