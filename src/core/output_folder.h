// A folder of files that belong together: all of them are written, or none.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/atomic_file.h"

namespace matchlight {

class OutputFolder {
public:
    /// Makes the folder where it is not there yet, and holds it for this run by a lock beside the last of `names`.
    /// Throws InputError: its parent does not exist, it is not writable, a file of `names` is in it already (unless
    /// `overwrite`).
    OutputFolder(std::filesystem::path folder, std::vector<std::string> names, bool overwrite);
    /// Takes a folder that it made away again when nothing was written.
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    /// The text of every file, in the order of the names. Throws InputError.
    void write(const std::vector<std::string>& texts) const;

    const std::filesystem::path& path() const { return folder_; }

private:
    std::filesystem::path folder_;
    std::vector<std::string> names_;
    bool made_ = false;
    std::optional<OutputLock> lock_;
};

}  // namespace matchlight
