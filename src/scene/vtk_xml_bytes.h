// The bytes of one array of a VTK XML file: raw or as base 64, packed by zlib in blocks or not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "scene/binary_number.h"
#include "scene/chunked_file.h"

namespace matchlight {

/// What holds for all arrays of a file.
struct VtkXmlCoding {
    bool is_big_endian = false;
    bool is_packed = false;  // by zlib
    NumberType header = NumberType::uint32;
};

class VtkXmlBytes {
public:
    /// Reads on from where `file` stands, which outlives this.
    VtkXmlBytes(ChunkedFile& file, const VtkXmlCoding& coding, bool is_base64);

    /// The next `count` bytes of the array, at most 1 MiB, until the next call. Throws InputError where there are
    /// fewer.
    std::string_view bytes(std::size_t count);
    /// Characters of the file that were taken: what is appended is found by them.
    std::uint64_t characters() const { return characters_; }

private:
    void begin();
    /// So many bytes as they are stored, until the next call.
    std::string_view stored(std::size_t count);
    std::uint64_t stored_number();
    void unpack_block();
    char character();

    ChunkedFile& file_;
    VtkXmlCoding coding_;
    bool is_base64_ = false, has_begun_ = false;
    std::uint64_t characters_ = 0;
    std::uint64_t left_ = 0;  // bytes of the array, where nothing is packed
    std::string stored_;
    std::array<char, 3> decoded_{};  // of the last four characters
    std::size_t decoded_begin_ = 0, decoded_end_ = 0;
    std::string packed_sizes_;  // of the blocks to come, as stored
    std::uint64_t blocks_ = 0, block_ = 0, block_bytes_ = 0, last_bytes_ = 0;
    std::string unpacked_;
    std::size_t unpacked_begin_ = 0;
};

}  // namespace matchlight
