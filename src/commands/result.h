// How a command prints what it found: text for people, JSON for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "commands/command.h"

namespace matchlight {

/// Prints `json` when --json was given, `text` otherwise, on standard output.
void print_result(const CommandContext& context, const nlohmann::json& json, const std::string& text);

}  // namespace matchlight
