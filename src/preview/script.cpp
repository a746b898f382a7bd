// The table of verbs, and what each takes.
#include "preview/script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "preview/controls.h"
#include "preview/keys.h"

namespace matchlight {

namespace {

struct Verb {
    std::string_view name;
    std::size_t least, most;  // words
    std::size_t numbers;      // the first so many of them, unless the first is a control's name
    std::string_view what;
};

constexpr std::array<Verb, 17> verbs{{
    {"wait_idle", 0, 0, 0, "until nothing is left to be drawn"},
    {"wait_busy", 0, 0, 0, "until something takes so long that the window tells it, or nothing is left to be drawn"},
    {"key", 1, 1, 0, "NAME: press a key, such as b or ctrl+z"},
    {"click", 1, 3, 2, "X Y [right|shift] or CONTROL: press and let go there"},
    {"drag", 4, 6, 4, "X0 Y0 X1 Y1 [STEPS] [right|middle|shift]: press, move in steps, let go"},
    {"slide", 2, 3, 0, "CONTROL SHARE [STEPS]: press in its middle, move in steps to that share of its width, let go"},
    {"scroll", 3, 3, 3, "X Y STEPS: turn the wheel there"},
    {"move", 2, 2, 2, "X Y: the pointer alone"},
    {"drop", 3, 3, 2, "X Y FILE: let a file go there"},
    {"set", 2, 2, 0, "CONTROL VALUE: change a control by its name, such as effects.bloom auto"},
    {"show", 1, 1, 0, "PANEL: open one of the panels"},
    {"type", 1, 1, 0, "TEXT: into the field that takes it"},
    {"frame", 1, 1, 1, "NUMBER: go there"},
    {"screenshot", 1, 1, 0, "OUT.png: of the whole window"},
    {"controls", 0, 0, 0, "print each control with its place"},
    {"measure", 1, 1, 0,
     "WORDS: print them, how soon pictures followed what was done last and how many a second while it lasted, when the "
     "last wait_idle found all of it there, and the program's processor time for it and memory"},
    {"quit", 0, 0, 0, "without a question"},
}};

std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words;
    std::size_t at = 0;
    while (true) {
        at = line.find_first_not_of(" \t\r", at);
        if (at == std::string::npos || line[at] == '#') return words;
        if (line[at] == '"') {
            const std::size_t end = line.find('"', at + 1);
            if (end == std::string::npos) throw std::invalid_argument("a quote is not closed");
            words.push_back(line.substr(at + 1, end - at - 1));
            at = end + 1;
        } else {
            const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
            words.push_back(line.substr(at, end - at));
            at = end;
        }
    }
}

std::optional<double> number_of(const std::string& word) {
    constexpr double largest = 1e6;  // of places in a window and of frames
    const std::optional<double> value = number_word(word);
    return value && std::abs(*value) <= largest ? value : std::nullopt;
}

ScriptStep step_of(std::vector<std::string> words) {
    ScriptStep step{.line = 0, .verb = words.front(), .words = {}, .numbers = {}};
    words.erase(words.begin());
    const auto verb = std::ranges::find(verbs, std::string_view(step.verb), &Verb::name);
    if (verb == verbs.end()) {
        std::string known;
        for (const Verb& one : verbs) known += (known.empty() ? "" : ", ") + std::string(one.name);
        throw std::invalid_argument(fmt::format("there is no '{}'; there are {}", step.verb, known));
    }
    if (words.size() < verb->least || words.size() > verb->most) {
        throw std::invalid_argument(fmt::format("it takes {}", verb->what));
    }
    const bool names_a_control = step.verb == "click" && words.size() == 1;
    if (!names_a_control) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            const std::optional<double> number = number_of(words[i]);
            if (!number && i < verb->numbers) throw std::invalid_argument(fmt::format("'{}' is no number", words[i]));
            if (number && verb->numbers > 0) step.numbers.push_back(*number);
        }
    }
    if (step.verb == "slide") {
        for (std::size_t i = 1; i < words.size(); ++i) {
            const std::optional<double> number = number_of(words[i]);
            if (!number) throw std::invalid_argument(fmt::format("'{}' is no number", words[i]));
            step.numbers.push_back(*number);
        }
    }
    if (step.verb == "key") event_of_key(words.front());  // throws where there is none
    step.words = std::move(words);
    return step;
}

}  // namespace

std::vector<ScriptStep> read_script(const std::filesystem::path& path) {
    std::vector<ScriptStep> steps;
    std::istringstream lines(read_text_file(path));
    std::int64_t number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        try {
            std::vector<std::string> words = words_of(line);
            if (words.empty()) continue;
            steps.push_back(step_of(std::move(words)));
            steps.back().line = number;
        } catch (const std::invalid_argument& error) {
            throw InputError({.file = path, .frame = {}, .cause = error.what(), .cure = {}, .line = number});
        }
    }
    return steps;
}

std::string script_help() {
    std::string text;
    for (const Verb& verb : verbs) text += fmt::format("{:<12} {}\n", verb.name, verb.what);
    return text;
}

}  // namespace matchlight
