// Files appear under their final name only when they are whole; two runs cannot write one output.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace matchlight {

/// A file written beside its final name and renamed when whole. The temporary name keeps the extension last
/// ("out_0001.part.png"), because encoders choose their format by it; it goes away again unless `commit` is reached.
class PendingFile {
public:
    explicit PendingFile(std::filesystem::path final_path);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;
    PendingFile(PendingFile&& other) noexcept;
    PendingFile& operator=(PendingFile&& other) = delete;

    /// Where to write until the file is whole.
    const std::filesystem::path& path() const { return temporary_path_; }
    const std::filesystem::path& final_path() const { return final_path_; }

    /// Flushes the file to the disk and gives it its final name. Throws InputError when the disk refuses.
    void commit();

private:
    std::filesystem::path final_path_;
    std::filesystem::path temporary_path_;
    bool pending_ = true;
};

/// Writes a small text file whole or not at all. Throws InputError.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// Reads a text file. Throws InputError when it is missing, is no regular file, or is longer than `limit_bytes`.
std::string read_text_file(const std::filesystem::path& path, std::size_t limit_bytes = 64u << 20);

/// Throws InputError unless `path` can be created: its folder exists and is writable, and it does not exist yet
/// (or `overwrite`).
void check_output(const std::filesystem::path& path, bool overwrite);

/// Holds an output name for one run: a lock file beside it, released with the process. Throws InputError when another
/// run holds it.
class OutputLock {
public:
    explicit OutputLock(const std::filesystem::path& output);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

private:
    std::filesystem::path lock_path_;
    int descriptor_ = -1;
};

}  // namespace matchlight
