// Byte by byte; files in pieces.
#include "core/content_hash.h"

#include <array>
#include <fstream>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

void ContentHash::mix(std::string_view bytes) {
    constexpr std::uint64_t fnv_prime = 0x100000001b3;
    for (const char byte : bytes) {
        state_ ^= static_cast<unsigned char>(byte);
        state_ *= fnv_prime;
    }
}

void ContentHash::add(std::string_view bytes) {
    mix(fmt::format("{}:", bytes.size()));
    mix(bytes);
}

void ContentHash::add_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(path, failure);
    if (!file || failure) throw InputError(path, "cannot be read");
    mix(fmt::format("{}:", size));
    std::array<char, 1 << 16> piece{};
    while (file.read(piece.data(), piece.size()) || file.gcount() > 0) {
        mix({piece.data(), static_cast<std::size_t>(file.gcount())});
    }
    if (file.bad()) throw InputError(path, "cannot be read to its end");
}

std::string ContentHash::hex() const {
    return fmt::format("{:016x}", state_);
}

}  // namespace matchlight
