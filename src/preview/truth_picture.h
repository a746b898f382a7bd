// How the scene really looked, where somebody knows: a picture beside a frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>

#include "core/image.h"

namespace matchlight {

class TruthPictures {
public:
    /// `truth` is a picture that holds for every frame, a numbered pattern ("truth_%03d.png"), or a folder of pictures
    /// whose names end in the frame's number; a folder is listed once. Throws InputError.
    explicit TruthPictures(std::filesystem::path truth);

    const std::filesystem::path& path() const { return truth_; }
    /// Nullopt where there is none of that frame. Throws InputError.
    std::optional<Image8> of_frame(std::int64_t frame) const;

private:
    std::filesystem::path truth_;
    bool is_folder_ = false;
    std::map<std::int64_t, std::filesystem::path> files_;  // of a folder, by their numbers
};

/// Throws InputError where the path names nothing of the kind.
void check_truth(const std::filesystem::path& truth);

}  // namespace matchlight
