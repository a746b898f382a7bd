// What every command is given and how it is entered in the table of main.cpp.
#pragma once

#include <CLI/App.hpp>

#include "core/warnings.h"

namespace matchlight {

/// Shared by all commands; lives as long as the program.
struct CommandContext {
    bool json = false;  // print the result for programs
    bool quiet = false;
    int verbosity = 0;
    Warnings warnings;
};

// One function a command: adds its subcommand to `app`; its callback runs the job and throws InputError to fail.
void add_board_command(CLI::App& app, CommandContext& context);
void add_calibrate_command(CLI::App& app, CommandContext& context);
void add_compare_command(CLI::App& app, CommandContext& context);
void add_doctor_command(CLI::App& app, CommandContext& context);
void add_export_command(CLI::App& app, CommandContext& context);
void add_lens_command(CLI::App& app, CommandContext& context);
void add_merge_command(CLI::App& app, CommandContext& context);
void add_preview_command(CLI::App& app, CommandContext& context);
void add_probe_command(CLI::App& app, CommandContext& context);
void add_render_command(CLI::App& app, CommandContext& context);
void add_report_command(CLI::App& app, CommandContext& context);
void add_response_command(CLI::App& app, CommandContext& context);
void add_spheres_command(CLI::App& app, CommandContext& context);
void add_track_command(CLI::App& app, CommandContext& context);

}  // namespace matchlight
