// matchlight probe: the subcommands that make light probes, tell what they hold and convert them.
#include <CLI/CLI.hpp>

#include "commands/command.h"
#include "commands/probe_commands.h"

namespace matchlight {

void add_probe_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("probe", "Light probes: what they hold, and conversion between mappings");
    command->require_subcommand(1);
    add_probe_info_command(*command, context);
    add_probe_convert_command(*command, context);
    add_probe_build_command(*command, context);
    add_probe_compare_command(*command, context);
    add_probe_calibrate_command(*command, context);
    add_probe_view_command(*command, context);
    add_probe_panorama_command(*command, context);
    add_probe_fisheye_command(*command, context);
}

}  // namespace matchlight
