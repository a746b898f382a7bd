// The one way a bad input is reported: file, frame, cause and cure, in one line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace matchlight {

/// What went wrong with an input, in the user's terms. `what()` joins the parts into a single line:
/// "table.mp4: frame 87: the file ends early: export the clip again".
struct InputErrorParts {
    std::filesystem::path file;         // empty where no file is concerned
    std::optional<std::int64_t> frame;  // counted from 0
    std::string cause;
    std::string cure;                  // empty where none is known
    std::optional<std::int64_t> line;  // of a text file, counted from 1: "table.toml:12: unknown key 'expsure_ev'"
};

/// A bad input or a failed job: the program ends with status 1. Programming errors are asserted instead.
class InputError : public std::runtime_error {
public:
    explicit InputError(InputErrorParts parts);
    InputError(const std::filesystem::path& file, std::string cause, std::string cure = {});
    InputError(const std::filesystem::path& file, std::int64_t frame, std::string cause, std::string cure = {});

    const InputErrorParts& parts() const { return parts_; }

private:
    InputErrorParts parts_;
};

/// Text made fit for one line of a terminal: control characters and newlines in file names become '?'.
std::string printable(const std::string& text);

}  // namespace matchlight
