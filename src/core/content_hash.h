// A number that tells contents apart: what an artefact was made from, so that it is made again when that changes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace matchlight {

/// FNV-1a (Fowler, Noll & Vo 1991), 64 bits. Each part is added with its length, so that parts cannot run together.
/// Against accidents, not against forgery.
class ContentHash {
public:
    void add(std::string_view bytes);
    /// The bytes of a file, not its name or times. Throws InputError when it cannot be read.
    void add_file(const std::filesystem::path& path);
    /// 16 hexadecimal digits.
    std::string hex() const;

private:
    void mix(std::string_view bytes);

    std::uint64_t state_ = 0xcbf29ce484222325;  // FNV's offset basis
};

}  // namespace matchlight
