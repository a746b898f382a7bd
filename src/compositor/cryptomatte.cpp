// Adds up the parts of one name in every pixel and ranks them.
#include "compositor/cryptomatte.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/parallel.h"

namespace matchlight {

namespace {

constexpr int rank_count = 6;

/// Little-endian, whatever the machine.
std::uint32_t four_bytes(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i)
        word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
    return word;
}

std::uint32_t mixed(std::uint32_t word) {
    return std::rotl(word * 0xcc9e2d51U, 15) * 0x1b873593U;
}

/// The specification's: exponents of all zeros or all ones would make zeros, infinities and NaNs.
std::uint32_t float_safe(std::uint32_t hash) {
    const std::uint32_t exponent = (hash >> 23U) & 255U;
    return exponent == 0 || exponent == 255 ? hash ^ (1U << 23U) : hash;
}

}  // namespace

std::uint32_t murmur3_32(std::string_view bytes) {
    std::uint32_t hash = 0;
    const std::size_t whole = bytes.size() / 4 * 4;
    for (std::size_t at = 0; at < whole; at += 4) {
        hash = std::rotl(hash ^ mixed(four_bytes(bytes, at)), 13) * 5 + 0xe6546b64U;
    }
    std::uint32_t rest = 0;
    for (std::size_t i = whole; i < bytes.size(); ++i)
        rest |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << (8 * (i - whole));
    if (whole < bytes.size()) hash ^= mixed(rest);
    hash ^= static_cast<std::uint32_t>(bytes.size());
    hash = (hash ^ (hash >> 16U)) * 0x85ebca6bU;
    hash = (hash ^ (hash >> 13U)) * 0xc2b2ae35U;
    return hash ^ (hash >> 16U);
}

float cryptomatte_id(std::string_view name) {
    return std::bit_cast<float>(float_safe(murmur3_32(name)));
}

Cryptomatte make_cryptomatte(const std::string& layer, const std::vector<std::string>& names, const ImageF& parts,
                             const ImageF& alpha) {
    assert(alpha.channels() == 1 && (parts.empty() || parts.width() == alpha.width()));
    Cryptomatte matte;
    matte.layer = layer;
    matte.ranks = ImageF(alpha.width(), alpha.height(), 2 * rank_count);
    for (int pair = 0; pair < rank_count; pair += 2) {
        for (const char* channel : {"R", "G", "B", "A"})
            matte.channels.push_back(fmt::format("{}{:02}.{}", layer, pair / 2, channel));
    }
    nlohmann::json manifest = nlohmann::json::object();
    std::vector<float> ids;
    for (const std::string& name : names) {
        ids.push_back(cryptomatte_id(name));
        manifest[name] = fmt::format("{:08x}", std::bit_cast<std::uint32_t>(ids.back()));
    }
    // The key is the first seven digits of the layer's own hash.
    const std::string key = "cryptomatte/" + fmt::format("{:08x}", murmur3_32(layer)).substr(0, 7) + "/";
    matte.metadata = {{key + "name", layer},
                      {key + "hash", "MurmurHash3_32"},
                      {key + "conversion", "uint32_to_float32"},
                      {key + "manifest", manifest.dump()}};
    if (parts.empty()) return matte;
    const int slots = parts.channels() / 2;
    parallel_for(alpha.height(), [&](int y) {
        std::vector<std::pair<float, float>> found;  // id, coverage
        for (int x = 0; x < alpha.width(); ++x) {
            found.clear();
            const float* slot = parts.pixel(x, y);
            float sum = 0;
            for (int i = 0; i < slots; ++i) {
                const auto part = static_cast<std::size_t>(slot[2 * i]);
                const float share = slot[2 * i + 1];
                if (part == 0 || !(share > 0)) continue;
                const float id = ids.at(part - 1);
                const auto same = std::ranges::find(found, id, &std::pair<float, float>::first);
                if (same != found.end()) {
                    same->second += share;
                } else {
                    found.emplace_back(id, share);
                }
                sum += share;
            }
            if (found.empty()) continue;
            std::ranges::stable_sort(found, std::greater<>(), &std::pair<float, float>::second);
            const float scale = alpha.at(x, y) / sum;
            float* out = matte.ranks.pixel(x, y);
            for (std::size_t rank = 0; rank < std::min<std::size_t>(found.size(), rank_count); ++rank) {
                out[2 * rank] = found[rank].first;
                out[2 * rank + 1] = found[rank].second * scale;
            }
        }
    });
    return matte;
}

}  // namespace matchlight
