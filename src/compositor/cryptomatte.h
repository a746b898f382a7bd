// Mattes of objects and materials that compositing programs pick by name: Cryptomatte.
//
// After Friedman & Jones 2015, "Fully Automatic ID Mattes with Support for Motion Blur and Transparency", and the
// Cryptomatte Specification 1.2.0 (Psyop).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "media/image_io.h"

namespace matchlight {

/// MurmurHash3_x86_32 (Appleby, public domain), seed 0.
std::uint32_t murmur3_32(std::string_view bytes);

/// The number of a name as a float that is neither zero-like, infinite nor NaN, and so survives any program: the
/// specification's uint32_to_float32.
float cryptomatte_id(std::string_view name);

/// Pairs of id and coverage, most coverage first, 0 where there are no more; six in every pixel.
struct Cryptomatte {
    std::string layer;                  // "CryptoObject"
    ImageF ranks;                       // 12 channels
    std::vector<std::string> channels;  // "CryptoObject00.R" (id), "CryptoObject00.G" (coverage), …
    ImageMetadata metadata;             // name, hash, conversion and the manifest
};

/// `parts` as FrameLayers has it, over pixels whose coverage by virtual things is `alpha` (1 channel); a part of number
/// n has the name names[n − 1], and parts of one name are one matte. Coverages of a pixel sum up to its alpha.
Cryptomatte make_cryptomatte(const std::string& layer, const std::vector<std::string>& names, const ImageF& parts,
                             const ImageF& alpha);

}  // namespace matchlight
