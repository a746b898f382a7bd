// The command table.
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "commands/command.h"
#include "core/error.h"
#include "core/stop.h"
#include "core/version.h"

namespace {

using matchlight::CommandContext;

using AddCommand = void (*)(CLI::App&, CommandContext&);
// One line a command, in the order the help shows them.
// clang-format off
const std::vector<AddCommand> command_table = {
    matchlight::add_board_command,
    matchlight::add_calibrate_command,
    matchlight::add_lens_command,
    matchlight::add_response_command,
    matchlight::add_merge_command,
    matchlight::add_probe_command,
    matchlight::add_spheres_command,
    matchlight::add_track_command,
    matchlight::add_render_command,
    matchlight::add_preview_command,
    matchlight::add_report_command,
    matchlight::add_export_command,
    matchlight::add_compare_command,
    matchlight::add_doctor_command,
};
// clang-format on

int report_failure(const char* what) {
    std::fprintf(stderr, "error: %s\n", what);
    return 1;
}

void repeat_warnings(const CommandContext& context) {
    if (context.warnings.empty() || context.quiet) return;
    const auto total = static_cast<long long>(context.warnings.total());
    std::fprintf(stderr, "%lld warning%s:\n", total, total == 1 ? "" : "s");
    for (const auto& entry : context.warnings.entries()) {
        std::fprintf(stderr, "  %lld× %s\n", static_cast<long long>(entry.count), entry.text.c_str());
    }
}

/// A result that did not reach its reader (a full disk behind a redirection) is a failed job.
int flush_results() {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
    return report_failure("standard output cannot be written");
}

int run(int argc, char** argv) {
    matchlight::install_stop_handlers();
    CLI::App app{"Composites 3D models onto recorded video so that they look as if the camera had filmed them."};
    app.set_version_flag("--version", std::string("matchlight ") + matchlight::version);
    app.require_subcommand(1);
    app.fallthrough();

    CommandContext context;
    app.add_flag("--json", context.json, "Print the result as JSON, for programs");
    app.add_flag("-q,--quiet", context.quiet, "No progress, no warnings on the terminal");
    app.add_flag("-v,--verbose", context.verbosity, "Say more (repeat for more)");
    app.parse_complete_callback([&] { context.warnings.set_quiet(context.quiet); });
    for (const auto add_command : command_table) add_command(app, context);

    int status = 0;
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;  // help and version end with 0, a wrong call with 2
    } catch (const std::bad_alloc&) {
        status = report_failure("there is not enough memory");
    } catch (const std::exception& error) {
        status = report_failure(error.what());
    }
    repeat_warnings(context);
    return status == 0 ? flush_results() : status;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        return report_failure(error.what());
    }
}
