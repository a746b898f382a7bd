// Pictures that come with the footage, one a frame: mattes of what is real and in front, and depths.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/image.h"
#include "core/warnings.h"
#include "media/frame_source.h"

namespace matchlight {

/// What they have to go with.
struct SideFootage {
    std::filesystem::path path;  // a video, or a pattern such as "matte_%04d.png"
    std::filesystem::path footage;
    int width = 0, height = 0;    // of the footage
    std::int64_t frames = 0;      // of the footage
    std::optional<double> scale;  // of depths: metres a unit; 1 for EXR, a millimetre for whole numbers unless given
};

/// How much of each pixel is real and in front of everything virtual.
class MatteSource {
public:
    /// `warnings` must outlive the source. Throws InputError: not to be read, of another size, or fewer frames.
    MatteSource(const SideFootage& side, Warnings& warnings);

    /// One channel, 0 to 1; frames may come in any order. Throws InputError.
    ImageF coverage(std::int64_t frame);

private:
    SideFootage side_;
    std::unique_ptr<FrameSource> source_;
    std::int64_t next_ = 0;
};

/// How far from the camera what each pixel shows is, along the camera's z.
class DepthSource {
public:
    /// As MatteSource; EXR sequences, too, with a channel Z, Y or R.
    DepthSource(const SideFootage& side, Warnings& warnings);

    /// One channel, 1/m, 0 where it is not known. NaN and negative depths are not known, and counted as warnings.
    ImageF inverse_depth(std::int64_t frame);

private:
    ImageF units(std::int64_t frame);
    ImageF exr_units(std::int64_t frame) const;

    SideFootage side_;
    Warnings& warnings_;
    std::unique_ptr<FrameSource> source_;  // null: EXR
    std::int64_t next_ = 0;
    std::int64_t first_number_ = 0;  // of EXR pictures
};

}  // namespace matchlight
