// matchlight spheres: sphere sets made, converted and told about.
#include <CLI/CLI.hpp>

#include "commands/command.h"
#include "commands/spheres_commands.h"

namespace matchlight {

void add_spheres_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("spheres", "Sphere sets: what they hold, conversion, sets for comparison");
    command->require_subcommand(1);
    add_spheres_info_command(*command, context);
    add_spheres_convert_command(*command, context);
    add_spheres_generate_command(*command, context);
}

}  // namespace matchlight
