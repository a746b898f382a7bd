// The subcommands of `matchlight spheres`, each in a file of its own.
#pragma once

#include <CLI/App.hpp>

#include "commands/command.h"

namespace matchlight {

// Each adds its subcommand to `spheres`; its callback runs the job and throws InputError to fail.
void add_spheres_info_command(CLI::App& spheres, CommandContext& context);
void add_spheres_convert_command(CLI::App& spheres, CommandContext& context);
void add_spheres_generate_command(CLI::App& spheres, CommandContext& context);

}  // namespace matchlight
