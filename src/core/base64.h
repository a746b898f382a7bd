// Bytes as text: base 64 (RFC 4648), for pictures inside pages and buffers inside glTF.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace matchlight {

std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace matchlight
