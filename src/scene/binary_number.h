// Numbers of any type and byte order in the bytes of a file.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace matchlight {

enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

inline std::size_t bytes_of(NumberType type) {
    switch (type) {
        case NumberType::int8:
        case NumberType::uint8:
            return 1;
        case NumberType::int16:
        case NumberType::uint16:
            return 2;
        case NumberType::int32:
        case NumberType::uint32:
        case NumberType::float32:
            return 4;
        default:
            return 8;
    }
}

inline std::uint64_t bits_at(const char* at, std::size_t bytes, bool is_big_endian) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
        bits = bits << 8 | static_cast<unsigned char>(at[is_big_endian ? i : bytes - 1 - i]);
    }
    return bits;
}

inline double number_at(const char* at, NumberType type, bool is_big_endian) {
    const std::uint64_t bits = bits_at(at, bytes_of(type), is_big_endian);
    switch (type) {
        case NumberType::int8:
            return static_cast<std::int8_t>(bits);
        case NumberType::int16:
            return static_cast<std::int16_t>(bits);
        case NumberType::int32:
            return static_cast<std::int32_t>(bits);
        case NumberType::int64:
            return static_cast<double>(static_cast<std::int64_t>(bits));
        case NumberType::float32:
            return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        case NumberType::float64:
            return std::bit_cast<double>(bits);
        default:
            return static_cast<double>(bits);
    }
}

}  // namespace matchlight
