// How the scene really looked, where somebody knows: a picture beside a frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/image.h"

namespace matchlight {

/// `truth` is a picture that holds for every frame, a numbered pattern ("truth_%03d.png"), or a folder of pictures
/// whose names end in the frame's number. Nullopt where there is none of that frame. Throws InputError.
std::optional<Image8> truth_picture(const std::filesystem::path& truth, std::int64_t frame);

/// Throws InputError where the path names nothing of the kind.
void check_truth(const std::filesystem::path& truth);

}  // namespace matchlight
