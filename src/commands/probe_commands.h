// The subcommands of `matchlight probe`, each in a file of its own.
#pragma once

#include <CLI/App.hpp>

#include "commands/command.h"

namespace matchlight {

// Each adds its subcommand to `probe`; its callback runs the job and throws InputError to fail.
void add_probe_calibrate_command(CLI::App& probe, CommandContext& context);
void add_probe_build_command(CLI::App& probe, CommandContext& context);
void add_probe_compare_command(CLI::App& probe, CommandContext& context);
void add_probe_convert_command(CLI::App& probe, CommandContext& context);
void add_probe_fisheye_command(CLI::App& probe, CommandContext& context);
void add_probe_info_command(CLI::App& probe, CommandContext& context);
void add_probe_view_command(CLI::App& probe, CommandContext& context);
void add_probe_panorama_command(CLI::App& probe, CommandContext& context);

}  // namespace matchlight
