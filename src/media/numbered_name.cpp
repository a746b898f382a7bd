// printf patterns of image sequences: exactly one %d or %0Nd, in the file name.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

namespace fs = std::filesystem;

struct NumberField {
    std::size_t begin = 0, end = 0;  // of the conversion inside the name
    int digits = 0;                  // zero-padded to at least this many
};

/// A conversion is "%", digits, a letter; a "%" followed by anything else is a plain character of the name.
std::optional<NumberField> find_number_field(const fs::path& pattern) {
    const std::string name = pattern.filename().string();
    std::optional<NumberField> found;
    for (std::size_t at = name.find('%'); at != std::string::npos; at = name.find('%', at + 1)) {
        std::size_t end = at + 1;
        while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
        if (end == name.size() || std::isalpha(static_cast<unsigned char>(name[end])) == 0) continue;
        const std::string width = name.substr(at + 1, end - at - 1);
        // More digits than a 64-bit number has would only make names too long for the file system.
        const bool width_ok = width.empty() || (width.front() == '0' && width.size() >= 2 && width.size() <= 3);
        if (name[end] != 'd' || !width_ok || (!width.empty() && std::stoi(width) > 18))
            throw InputError(pattern, fmt::format("\"{}\" is no frame number", name.substr(at, end + 1 - at)),
                             "use %d or %04d");
        if (found) throw InputError(pattern, "has two frame numbers", "use a single %d or %04d");
        found = NumberField{at, end + 1, width.empty() ? 0 : std::stoi(width)};
    }
    return found;
}

}  // namespace

fs::path numbered(const fs::path& pattern, std::int64_t number) {
    const std::optional<NumberField> field = find_number_field(pattern);
    if (!field) return pattern;
    const std::string name = pattern.filename().string();
    return pattern.parent_path() /
           (name.substr(0, field->begin) + fmt::format("{:0{}}", number, field->digits) + name.substr(field->end));
}

bool is_pattern(const fs::path& path) {
    return find_number_field(path).has_value();
}

std::vector<std::int64_t> numbers_of_pattern(const fs::path& pattern) {
    const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
    std::error_code error;
    std::vector<std::int64_t> numbers;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        // Any run of digits may be the number: the pattern decides by giving the same name back.
        for (std::size_t at = 0; at < name.size(); ++at) {
            if (std::isdigit(static_cast<unsigned char>(name[at])) == 0) continue;
            std::int64_t number = 0;
            const auto parsed = std::from_chars(name.data() + at, name.data() + name.size(), number);
            if (parsed.ec == std::errc() && numbered(pattern, number).filename() == name) {
                numbers.push_back(number);
                break;
            }
            at = static_cast<std::size_t>(parsed.ptr - name.data());
        }
    }
    if (error) throw InputError(pattern, "its folder cannot be read: " + error.message());
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

}  // namespace matchlight
