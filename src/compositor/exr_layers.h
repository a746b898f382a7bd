// The layers of a frame as a multi-part EXR that other programs put together again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "compositor/compositor.h"

namespace matchlight {

/// What a file tells of where it comes from.
struct ExrOrigin {
    std::int64_t number = 0;  // of the frame, as the file's name has it
    std::filesystem::path scene;
    std::string provenance;  // effective scene, version
};

/// Parts beauty, plate, shadow, alpha, virtual, coverage, reflection, spill, grain, clipped, depth, normal, motion,
/// object_id, CryptoObject, CryptoMaterial, of which
///     beauty = plate · shadow · (1 − coverage) + reflection + virtual + spill + grain
/// in camera-linear light, and the code values of a picture are response(tone(beauty)). Each part's header says its
/// unit, and how its light goes with the probe's. Throws InputError.
void write_exr_layers(const std::filesystem::path& path, const CompositedFrame& frame, const Compositor& compositor,
                      const ExrOrigin& origin);

}  // namespace matchlight
