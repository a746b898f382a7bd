// Pictures on models, decoded to RGBA.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/image.h"
#include "core/warnings.h"
#include "scene/checked_model.h"

namespace matchlight {

/// 4-channel 8-bit pixels with straight alpha, of any format OpenImageIO reads. A picture that is missing or damaged is
/// counted as a warning and nullopt. Throws InputError naming `model` when the header asks for more than 16384 pixels a
/// side or more memory than there is: it is not decoded then.
std::optional<Image8> read_texture(const TextureSource& source, const std::filesystem::path& model, Warnings& warnings);

}  // namespace matchlight
