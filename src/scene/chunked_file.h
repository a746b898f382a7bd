// Reads a file of any length a chunk at a time, as lines or as bytes; what gzip has packed is unpacked on the way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

struct gzFile_s;

namespace matchlight {

class ChunkedFile {
public:
    /// Bytes that are looked at at once, and the longest line.
    static constexpr std::size_t chunk_bytes = 1u << 20;

    /// Throws InputError: missing, no regular file, empty.
    explicit ChunkedFile(std::filesystem::path path);
    ~ChunkedFile();
    ChunkedFile(const ChunkedFile&) = delete;
    ChunkedFile& operator=(const ChunkedFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// The next line without its end (LF or CR LF), until the next call; nullopt after the last.
    std::optional<std::string_view> line();
    /// As line(), where the file must not end yet: `wanted` is what is missing then.
    std::string_view needed_line(std::string_view wanted);
    /// The next `count` bytes, at most chunk_bytes, until the next call. Throws InputError where the file ends before.
    std::string_view bytes(std::size_t count, std::string_view wanted);
    void skip(std::uint64_t count, std::string_view wanted);
    /// The next byte without taking it; nullopt at the end.
    std::optional<char> peek();

    /// The line read last, counted from 1.
    std::int64_t line_number() const { return line_number_; }
    /// Throws InputError unless `count` things of at least `least_bytes` each can be in the file.
    void check_count(std::uint64_t count, std::uint64_t least_bytes, std::string_view things) const;
    /// Throws an InputError that names the line, where lines were read.
    [[noreturn]] void fail(const std::string& cause, const std::string& cure = {}) const;

private:
    /// Reads on until `count` bytes are at hand or the file ends.
    void fill(std::size_t count);
    std::size_t at_hand() const { return end_ - begin_; }

    std::filesystem::path path_;
    gzFile_s* file_ = nullptr;
    std::vector<char> buffer_;
    std::size_t begin_ = 0, end_ = 0;  // of what is at hand
    bool ended_ = false;
    std::int64_t line_number_ = 0;
    std::uint64_t file_bytes_ = 0;
};

}  // namespace matchlight
