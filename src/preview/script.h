// A scripted hand: events from a file, played one after another into the window.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

namespace matchlight {

/// A line of a script: "drag 10 20 200 40 8".
struct ScriptStep {
    std::int64_t line = 0;
    std::string verb;
    std::vector<std::string> words;  // after the verb; quotes are gone
    std::vector<double> numbers;     // those of the words that are numbers, where the verb takes numbers
};

/// Reads a script: a verb and its words a line; what follows # is a remark. Throws InputError naming file and line.
std::vector<ScriptStep> read_script(const std::filesystem::path& path);

/// One line a verb, for --help.
std::string script_help();

}  // namespace matchlight
