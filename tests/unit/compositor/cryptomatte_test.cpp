// Hashes against published ones, ranks against sums by hand.
#include "compositor/cryptomatte.h"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace matchlight {
namespace {

TEST(Cryptomatte, HashesAsMurmur3) {
    // Appleby's verification strings, as common implementations list them.
    EXPECT_EQ(murmur3_32(""), 0U);
    EXPECT_EQ(murmur3_32("hello"), 0x248bfa47U);
    EXPECT_EQ(murmur3_32("hello, world"), 0x149bbb7fU);
    EXPECT_EQ(murmur3_32("The quick brown fox jumps over the lazy dog"), 0x2e4ff723U);
    // The keys that other renderers' files have for these layers.
    EXPECT_EQ(murmur3_32("crypto_object") >> 4U, 0xf834d0aU);
    EXPECT_EQ(murmur3_32("crypto_material") >> 4U, 0xbda530aU);
}

TEST(Cryptomatte, IdsAreOrdinaryFloats) {
    for (int i = 0; i < 20000; ++i) {
        const float id = cryptomatte_id("object " + std::to_string(i));
        ASSERT_TRUE(std::isnormal(id)) << i;
    }
}

TEST(Cryptomatte, RanksPartsOfOneNameTogether) {
    // Three parts, of which the first and the third are of one material, in a pixel that is covered by 0.8.
    ImageF parts(2, 1, 16), alpha(2, 1, 1);
    const float slots[] = {2, 0.35F, 1, 0.25F, 3, 0.2F};
    std::copy(std::begin(slots), std::end(slots), parts.pixel(1, 0));
    alpha.at(1, 0) = 0.8F;
    const Cryptomatte matte = make_cryptomatte("CryptoMaterial", {"steel", "wood", "steel"}, parts, alpha);
    ASSERT_EQ(matte.ranks.channels(), 12);
    EXPECT_EQ(matte.ranks.at(1, 0, 0), cryptomatte_id("steel"));
    EXPECT_NEAR(matte.ranks.at(1, 0, 1), 0.45, 1e-6);
    EXPECT_EQ(matte.ranks.at(1, 0, 2), cryptomatte_id("wood"));
    EXPECT_NEAR(matte.ranks.at(1, 0, 3), 0.35, 1e-6);
    for (int c = 4; c < 12; ++c) EXPECT_EQ(matte.ranks.at(1, 0, c), 0);
    for (int c = 0; c < 12; ++c) EXPECT_EQ(matte.ranks.at(0, 0, c), 0);
    // What is in view of the parts covers only half of the pixel by itself: the shares go up to what is covered.
    alpha.at(1, 0) = 0.4F;
    EXPECT_NEAR(make_cryptomatte("CryptoMaterial", {"steel", "wood", "steel"}, parts, alpha).ranks.at(1, 0, 1), 0.225,
                1e-6);
}

TEST(Cryptomatte, TellsNamesInItsManifest) {
    const Cryptomatte matte = make_cryptomatte("crypto_object", {"a \"ball\"", "Kugel ö"}, {}, ImageF(1, 1, 1));
    EXPECT_EQ(matte.metadata.at("cryptomatte/f834d0a/name"), "crypto_object");
    EXPECT_EQ(matte.metadata.at("cryptomatte/f834d0a/hash"), "MurmurHash3_32");
    EXPECT_EQ(matte.metadata.at("cryptomatte/f834d0a/conversion"), "uint32_to_float32");
    const auto manifest = nlohmann::json::parse(matte.metadata.at("cryptomatte/f834d0a/manifest"));
    ASSERT_EQ(manifest.size(), 2U);
    for (const auto& [name, hex] : manifest.items()) {
        const auto bits = static_cast<std::uint32_t>(std::stoul(hex.get<std::string>(), nullptr, 16));
        EXPECT_EQ(std::bit_cast<float>(bits), cryptomatte_id(name));
    }
    EXPECT_EQ(matte.channels.front(), "crypto_object00.R");
    EXPECT_EQ(matte.channels.back(), "crypto_object02.A");
}

}  // namespace
}  // namespace matchlight
