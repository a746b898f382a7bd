// zlib reads packed and plain files alike.
#include "scene/chunked_file.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "core/error.h"

namespace matchlight {

ChunkedFile::ChunkedFile(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code failure;
    const auto status = std::filesystem::status(path_, failure);
    if (!std::filesystem::exists(status)) throw InputError(path_, "no such file", "check its name and folder");
    if (!std::filesystem::is_regular_file(status))
        throw InputError(path_, "is not a regular file", "name a file of spheres");
    file_bytes_ = std::filesystem::file_size(path_, failure);
    if (failure) throw InputError(path_, "cannot be read: " + failure.message());
    if (file_bytes_ == 0) throw InputError(path_, "is empty", "write or copy it again");
    buffer_.resize(2 * chunk_bytes);
    file_ = gzopen(path_.c_str(), "rb");
    if (file_ == nullptr) throw InputError(path_, "cannot be read");
    gzbuffer(file_, 1u << 17);
}

ChunkedFile::~ChunkedFile() {
    gzclose(file_);
}

void ChunkedFile::fill(std::size_t count) {
    assert(count <= chunk_bytes);
    if (at_hand() >= count || ended_) return;
    std::memmove(buffer_.data(), buffer_.data() + begin_, at_hand());
    end_ = at_hand();
    begin_ = 0;
    while (end_ < count && !ended_) {
        const auto room = static_cast<unsigned>(buffer_.size() - end_);
        const int got = gzread(file_, buffer_.data() + end_, room);
        int error = Z_OK;
        const char* reason = gzerror(file_, &error);
        if (got < 0 || error == Z_BUF_ERROR) {
            fail(fmt::format("cannot be read: {}", error == Z_BUF_ERROR ? "its packed data ends early" : reason));
        }
        end_ += static_cast<std::size_t>(got);
        ended_ = static_cast<unsigned>(got) < room;
    }
}

std::optional<std::string_view> ChunkedFile::line() {
    const auto ending = [&]() -> const char* {
        return static_cast<const char*>(std::memchr(buffer_.data() + begin_, '\n', at_hand()));
    };
    const char* end = ending();
    if (end == nullptr) {
        fill(chunk_bytes);
        end = ending();
    }
    if (at_hand() == 0) return std::nullopt;
    ++line_number_;
    const std::size_t start = begin_;
    std::size_t length = at_hand();
    if (end != nullptr) {
        length = static_cast<std::size_t>(end - (buffer_.data() + begin_));
    } else if (!ended_) {
        fail(fmt::format("the line is longer than {} bytes", chunk_bytes));
    }
    begin_ += end != nullptr ? length + 1 : length;
    if (length > 0 && buffer_[start + length - 1] == '\r') --length;
    return std::string_view(buffer_.data() + start, length);
}

std::string_view ChunkedFile::needed_line(std::string_view wanted) {
    const auto next = line();
    if (!next) throw InputError(path_, fmt::format("it ends before {}", wanted), "write or copy it again whole");
    return *next;
}

std::string_view ChunkedFile::bytes(std::size_t count, std::string_view wanted) {
    fill(count);
    if (at_hand() < count) throw InputError(path_, fmt::format("it ends inside {}", wanted));
    begin_ += count;
    return {buffer_.data() + begin_ - count, count};
}

void ChunkedFile::skip(std::uint64_t count, std::string_view wanted) {
    while (count > 0) {
        const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(count, chunk_bytes));
        bytes(now, wanted);
        count -= now;
    }
}

std::optional<char> ChunkedFile::peek() {
    fill(1);
    if (at_hand() == 0) return std::nullopt;
    return buffer_[begin_];
}

void ChunkedFile::check_count(std::uint64_t count, std::uint64_t least_bytes, std::string_view things) const {
    // What deflate packs comes out at most 1032 times as long (zlib's own figure).
    const std::uint64_t most_bytes = gzdirect(file_) == 1 ? file_bytes_ : file_bytes_ * 1032;
    // The last line needs no end.
    if (count <= (most_bytes + 1) / least_bytes) return;
    fail(fmt::format("it promises {} {}, more than its {} bytes hold", count, things, file_bytes_),
         "write or copy it again whole, or correct the number");
}

void ChunkedFile::fail(const std::string& cause, const std::string& cure) const {
    const auto line = line_number_ > 0 ? std::optional(line_number_) : std::nullopt;
    throw InputError(InputErrorParts{path_, std::nullopt, cause, cure, line});
}

}  // namespace matchlight
