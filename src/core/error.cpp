// Joins the parts of an input error into the line a user reads.
#include "core/error.h"

#include <fmt/format.h>

namespace matchlight {

std::string printable(const std::string& text) {
    std::string clean = text;
    for (char& c : clean) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    }
    return clean;
}

namespace {

std::string one_line(const InputErrorParts& parts) {
    std::string line;
    if (!parts.file.empty()) line += parts.file.string();
    if (parts.line) line += fmt::format(":{}", *parts.line);
    if (!line.empty()) line += ": ";
    if (parts.frame) line += fmt::format("frame {}: ", *parts.frame);
    line += parts.cause;
    if (!parts.cure.empty()) line += "; " + parts.cure;
    return printable(line);
}

}  // namespace

InputError::InputError(InputErrorParts parts) : std::runtime_error(one_line(parts)), parts_(std::move(parts)) {}

InputError::InputError(const std::filesystem::path& file, std::string cause, std::string cure)
    : InputError(InputErrorParts{file, std::nullopt, std::move(cause), std::move(cure), std::nullopt}) {}

InputError::InputError(const std::filesystem::path& file, std::int64_t frame, std::string cause, std::string cure)
    : InputError(InputErrorParts{file, frame, std::move(cause), std::move(cure), std::nullopt}) {}

}  // namespace matchlight
