// VTK writes before an array the number of its bytes; where it is packed, the number of blocks, the bytes of a block
// and of the last if it is shorter, and what each block takes packed.
#include "scene/vtk_xml_bytes.h"

#include <algorithm>

#include <zlib.h>

#include "core/error.h"

namespace matchlight {
namespace {

/// VTK's own blocks are of 32 KiB.
constexpr std::uint64_t largest_block = 64u << 20;

int value_of(char digit) {
    if (digit >= 'A' && digit <= 'Z') return digit - 'A';
    if (digit >= 'a' && digit <= 'z') return digit - 'a' + 26;
    if (digit >= '0' && digit <= '9') return digit - '0' + 52;
    if (digit == '+') return 62;
    return digit == '/' ? 63 : -1;
}

}  // namespace

VtkXmlBytes::VtkXmlBytes(ChunkedFile& file, const VtkXmlCoding& coding, bool is_base64)
    : file_(file), coding_(coding), is_base64_(is_base64) {}

char VtkXmlBytes::character() {
    ++characters_;
    return file_.bytes(1, "an array").front();
}

std::string_view VtkXmlBytes::stored(std::size_t count) {
    if (!is_base64_) {
        characters_ += count;
        return file_.bytes(count, "an array");
    }
    stored_.clear();
    while (stored_.size() < count) {
        if (decoded_begin_ == decoded_end_) {
            std::uint32_t bits = 0;
            int digits = 0;
            for (int i = 0; i < 4;) {
                const char next = character();
                if (next == ' ' || next == '\n' || next == '\r' || next == '\t') continue;
                const int value = value_of(next);
                if (value < 0 && next != '=') throw InputError(file_.path(), "an array is no base 64");
                if (value >= 0) ++digits;
                bits = bits << 6 | static_cast<std::uint32_t>(std::max(value, 0));
                ++i;
            }
            // What is coded separately, as a header is, ends in padding of its own.
            decoded_begin_ = 0;
            decoded_end_ = digits == 4 ? 3 : digits == 3 ? 2 : 1;
            for (std::size_t i = 0; i < 3; ++i) decoded_[i] = static_cast<char>(bits >> (16 - 8 * i) & 255);
        }
        stored_ += decoded_[decoded_begin_++];
    }
    return stored_;
}

std::uint64_t VtkXmlBytes::stored_number() {
    const std::size_t bytes = bytes_of(coding_.header);
    return bits_at(stored(bytes).data(), bytes, coding_.is_big_endian);
}

void VtkXmlBytes::begin() {
    has_begun_ = true;
    if (!coding_.is_packed) {
        left_ = stored_number();
        return;
    }
    blocks_ = stored_number();
    block_bytes_ = stored_number();
    last_bytes_ = stored_number();
    file_.check_count(blocks_, bytes_of(coding_.header), "blocks");
    if (block_bytes_ > largest_block || last_bytes_ > block_bytes_) {
        throw InputError(file_.path(), "an array has blocks of a wrong size");
    }
    for (std::uint64_t i = 0; i < blocks_; ++i) packed_sizes_ += stored(bytes_of(coding_.header));
}

void VtkXmlBytes::unpack_block() {
    if (block_ == blocks_) throw InputError(file_.path(), "an array is shorter than its points are many");
    const std::size_t bytes = bytes_of(coding_.header);
    const std::uint64_t packed = bits_at(packed_sizes_.data() + block_ * bytes, bytes, coding_.is_big_endian);
    const bool is_short = block_ + 1 == blocks_ && last_bytes_ > 0;
    auto length = static_cast<uLongf>(is_short ? last_bytes_ : block_bytes_);
    if (packed > compressBound(length) + 1024) throw InputError(file_.path(), "an array has blocks of a wrong size");
    std::string source;
    for (std::uint64_t left = packed; left > 0;) {
        const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(left, ChunkedFile::chunk_bytes));
        source += stored(now);
        left -= now;
    }
    unpacked_.erase(0, unpacked_begin_);
    unpacked_begin_ = 0;
    const std::size_t before = unpacked_.size();
    const uLongf expected = length;
    unpacked_.resize(before + length);
    const int status = uncompress(reinterpret_cast<Bytef*>(unpacked_.data() + before), &length,
                                  reinterpret_cast<const Bytef*>(source.data()), static_cast<uLong>(source.size()));
    if (status != Z_OK || length != expected) throw InputError(file_.path(), "an array cannot be unpacked");
    ++block_;
}

std::string_view VtkXmlBytes::bytes(std::size_t count) {
    if (!has_begun_) begin();
    if (!coding_.is_packed) {
        if (count > left_) throw InputError(file_.path(), "an array is shorter than its points are many");
        left_ -= count;
        return stored(count);
    }
    while (unpacked_.size() - unpacked_begin_ < count) unpack_block();
    unpacked_begin_ += count;
    return std::string_view(unpacked_).substr(unpacked_begin_ - count, count);
}

}  // namespace matchlight
