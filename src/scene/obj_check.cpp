// Checks OBJ and MTL files, and hands on only the lines that a loader needs.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"
#include "scene/checked_model.h"
#include "scene/confined_path.h"

namespace matchlight {
namespace {

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

/// Takes the first word off `text`.
std::string_view take_word(std::string_view& text) {
    text = trimmed(text);
    std::size_t end = 0;
    while (end < text.size() && !is_space(text[end])) ++end;
    const std::string_view word = text.substr(0, end);
    text = trimmed(text.substr(end));
    return word;
}

/// Calls `line(number, text)` for each line, with those that end in a backslash joined.
template <class Line>
void for_each_line(std::string_view text, const Line& line) {
    std::string joined;
    std::int64_t number = 0;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        std::string_view one = trimmed(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        ++number;
        if (one.ends_with('\\')) {
            joined.append(one.substr(0, one.size() - 1)).append(" ");
            continue;
        }
        if (joined.empty()) {
            line(number, one);
        } else {
            joined.append(one);
            line(number, std::string_view(joined));
            joined.clear();
        }
    }
    if (!joined.empty()) line(number, std::string_view(joined));
}

std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return lower;
}

bool starts_like_a_number(std::string_view text) {
    return !text.empty() && (std::string_view("+-.0123456789").find(text.front()) != std::string_view::npos);
}

class ObjChecker {
public:
    ObjChecker(const std::filesystem::path& path, Warnings& warnings) : warnings_(warnings) {
        checked_.path = path;
        checked_.entry = "model.obj";
    }

    CheckedModel check() {
        const std::string text = read_binary_file(checked_.path);
        std::string& clean = checked_.files["model.obj"];
        clean.reserve(text.size());
        for_each_line(text, [&](std::int64_t number, std::string_view line) { add_line(number, line, clean); });
        for (std::size_t kind = 0; kind < 3; ++kind) {
            if (largest_[kind].index > counts_[kind]) {
                fail(largest_[kind].line, fmt::format("{} index {} is beyond the {} there are", kinds[kind],
                                                      largest_[kind].index, counts_[kind]));
            }
        }
        // assimp keeps a vertex for each corner of a face, beside the parsed lists.
        const std::uint64_t needed = corners_ * 160;
        if (needed > available_memory_bytes()) {
            throw InputError(checked_.path, fmt::format("it needs {} MB of memory, more than there is", needed >> 20));
        }
        return std::move(checked_);
    }

private:
    static constexpr const char* kinds[] = {"vertex", "texture coordinate", "normal"};
    struct Largest {
        std::int64_t index = 0;
        std::int64_t line = 0;
    };

    [[noreturn]] void fail(std::int64_t line, const std::string& cause) const {
        throw InputError(InputErrorParts{checked_.path, std::nullopt, cause, "", line});
    }
    void add_line(std::int64_t number, std::string_view line, std::string& clean);
    void add_face(std::int64_t number, std::string_view corners, std::string& clean);
    void check_index(std::int64_t number, std::size_t kind, std::string_view text);
    void add_library(std::string_view name, std::string& clean);
    std::string clean_library(std::string_view text, const std::string& folder);
    void add_map(std::string_view keyword, std::string_view rest, const std::string& folder, std::string& clean);

    CheckedModel checked_;
    Warnings& warnings_;
    std::array<std::int64_t, 3> counts_{};
    std::array<Largest, 3> largest_{};
    std::uint64_t corners_ = 0;
    std::set<std::string> libraries_;
};

void ObjChecker::add_line(std::int64_t number, std::string_view line, std::string& clean) {
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword == "f") {
        add_face(number, rest, clean);
        return;
    }
    if (keyword == "mtllib") {
        add_library(rest, clean);
        return;
    }
    const bool is_vertex = keyword == "v" || keyword == "vn";
    if (is_vertex || keyword == "vt") {
        std::size_t numbers = 0;
        for (std::string_view left = rest; !left.empty(); ++numbers) take_word(left);
        if (numbers < (is_vertex ? 3u : 1u)) fail(number, fmt::format("'{}' has {} numbers", keyword, numbers));
        ++counts_[keyword == "v" ? 0 : keyword == "vt" ? 1 : 2];
    } else if (keyword != "o" && keyword != "g" && keyword != "s" && keyword != "usemtl") {
        return;  // lines, points, curves, comments
    }
    clean.append(line).append("\n");
}

void ObjChecker::check_index(std::int64_t number, std::size_t kind, std::string_view text) {
    std::int64_t index = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), index);
    if (failure != std::errc() || end != text.data() + text.size()) {
        fail(number, fmt::format("'{}' is no {} index", text.substr(0, 40), kinds[kind]));
    }
    if (index == 0) fail(number, fmt::format("{} index 0: they count from 1", kinds[kind]));
    if (index < 0 && -index > counts_[kind]) {
        fail(number, fmt::format("{} index {} reaches before the first of {}", kinds[kind], index, counts_[kind]));
    }
    if (index > largest_[kind].index) largest_[kind] = {index, number};
}

void ObjChecker::add_face(std::int64_t number, std::string_view corners, std::string& clean) {
    std::size_t count = 0;
    for (std::string_view left = corners; !left.empty(); ++count) {
        std::string_view corner = take_word(left);
        for (std::size_t kind = 0; kind < 3; ++kind) {
            const std::size_t slash = corner.find('/');
            const std::string_view index = corner.substr(0, slash);
            if (!index.empty() || kind == 0) check_index(number, kind, index);
            if (slash == std::string_view::npos) break;
            corner.remove_prefix(slash + 1);
        }
    }
    if (count < 3) {
        warnings_.add(fmt::format("{}: faces with fewer than three corners, left out", checked_.path.string()));
        return;
    }
    corners_ += count;
    clean.append("f ").append(corners).append("\n");
}

void ObjChecker::add_library(std::string_view name, std::string& clean) {
    const std::string library(name);
    if (library.empty() || !libraries_.insert(library).second) return;
    const std::filesystem::path file = ModelFolder{checked_.path}.inside(library);
    std::error_code failure;
    if (!std::filesystem::is_regular_file(file, failure)) {
        warnings_.add(fmt::format("{}: its materials '{}' are missing, left out", checked_.path.string(), library));
        return;
    }
    const std::size_t slash = library.find_last_of("/\\");
    const std::string folder = slash == std::string::npos ? "" : library.substr(0, slash + 1);
    const std::string clean_name = fmt::format("{}.mtl", libraries_.size());
    checked_.files[clean_name] = clean_library(read_binary_file(file), folder);
    clean.append("mtllib ").append(clean_name).append("\n");
}

/// assimp 5.2 reads past the end of some lines, and writes to a material before there is one.
std::string ObjChecker::clean_library(std::string_view text, const std::string& folder) {
    static const std::set<std::string, std::less<>> values = {"kd", "ks", "ke", "ns", "d", "tr", "illum", "pr", "pm"};
    static const std::set<std::string, std::less<>> maps = {"map_kd", "map_ke", "map_emissive", "norm", "map_kn"};
    std::string clean;
    bool in_material = false;
    for_each_line(text, [&](std::int64_t, std::string_view line) {
        std::string_view rest = line;
        const std::string keyword = lower_case(take_word(rest));
        if (keyword == "newmtl" && !rest.empty()) {
            in_material = true;
            clean.append("newmtl ").append(rest).append("\n");
        } else if (!in_material) {
            return;
        } else if (values.contains(keyword) && starts_like_a_number(rest)) {
            clean.append(line).append("\n");
        } else if (maps.contains(keyword)) {
            add_map(line.substr(0, keyword.size()), rest, folder, clean);
        } else if (keyword.starts_with("map_") || keyword == "bump" || keyword == "disp" || keyword == "refl") {
            warnings_.add(fmt::format("{}: the texture of '{}' is left out", checked_.path.string(), keyword));
        }
    });
    return clean;
}

/// "map_Kd -clamp on a b.png": options, each with its arguments, then the file's name to the end of the line.
void ObjChecker::add_map(std::string_view keyword, std::string_view rest, const std::string& folder,
                         std::string& clean) {
    bool clamped = false;
    while (rest.starts_with('-')) {
        std::string_view after = rest;
        const std::string option = lower_case(take_word(after));
        const bool has_word = option == "-clamp" || option == "-blendu" || option == "-blendv" || option == "-cc" ||
                              option == "-imfchan" || option == "-type";
        const bool has_numbers = option == "-o" || option == "-s" || option == "-t" || option == "-mm" ||
                                 option == "-bm" || option == "-boost" || option == "-texres";
        if (!has_word && !has_numbers) break;  // a name may start with '-' too
        rest = after;
        if (has_word) {
            const std::string argument = lower_case(take_word(rest));
            if (option == "-clamp") clamped = argument == "on";
        }
        while (has_numbers && starts_like_a_number(rest)) {
            std::string_view left = rest;
            const std::string_view word = take_word(left);
            double number = 0;
            const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
            if (failure != std::errc() || end != word.data() + word.size()) break;  // "1stfloor.png"
            rest = left;
        }
    }
    TextureSource source{std::string(rest), "", {}};
    try {
        source.file = ModelFolder{checked_.path}.inside(folder + source.name);
    } catch (const InputError& error) {
        // Exporters write the absolute paths of the machine they ran on.
        warnings_.add(fmt::format("{}: the texture is left out", error.what()));
        return;
    }
    clean += fmt::format("{}{} texture-{}\n", keyword, clamped ? " -clamp on" : "", checked_.textures.size());
    checked_.textures.push_back(std::move(source));
}

}  // namespace

CheckedModel check_obj(const std::filesystem::path& path, Warnings& warnings) {
    return ObjChecker(path, warnings).check();
}

}  // namespace matchlight
