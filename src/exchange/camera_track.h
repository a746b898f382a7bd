// What every camera file is written from: a part of a solve, numbered and timed as other programs want it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/warnings.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// A picture without distortion: what a camera of other programs films. Pixels, centres at whole numbers.
struct PinholePicture {
    int width = 0, height = 0;
    double fx = 0, fy = 0, cx = 0, cy = 0;
};

/// The footage's lens without its distortion. `centred` also puts the principal point into the middle and makes pixels
/// square (fy holds), for formats that know nothing else; a plate undistorted by an STMap made so fits it exactly.
PinholePicture pinhole_of(const Camera& camera, bool centred);

struct CameraTrackOptions {
    std::int64_t first_frame = 0;
    std::optional<std::int64_t> last_frame;  // included
    std::int64_t first_number = 0;           // of frame 0 in the other program
    std::optional<double> fps;               // instead of the footage's time stamps
    double sensor_width_mm = 36;             // where millimetres are wanted: the solve knows pixels alone
    bool centred = false;
};

struct CameraTrack {
    std::string source;  // the footage's name, for the files' comments
    Camera camera;       // with its distortion
    PinholePicture pinhole;
    double sensor_width_mm = 36;
    double fps = 25;
    std::vector<SolvedTag> rig;
    std::vector<SolvedFrame> frames;  // `frame` is the other program's number, `time_s` strictly ascends
    std::int64_t first_number = 0;

    std::int64_t posed() const;
    /// Focal length on the sensor that `sensor_width_mm` stands for.
    double focal_mm() const { return pinhole.fx * mm_per_px(); }
    double mm_per_px() const { return sensor_width_mm / pinhole.width; }
};

/// Warns of uneven time stamps and of frames without a pose. Throws InputError (naming `reported`) when no frame of the
/// range has a pose.
CameraTrack camera_track(const Solve& solve, const CameraTrackOptions& options, const std::filesystem::path& reported,
                         Warnings& warnings);

/// Frames a second from time stamps: their mean, or the usual rate (a whole number, or one over 1.001) that is as near
/// as stamps of a millisecond tell. nullopt for fewer than two frames or stamps that do not ascend.
std::optional<double> frame_rate(const std::vector<SolvedFrame>& frames);

/// What another program's camera cannot hold of this one, in words; empty where nothing is lost.
struct CameraLimits {
    bool offset = true;        // of the principal point
    bool pixel_aspect = true;  // fx other than fy
    bool distortion = false;   // all of the lens
};
std::vector<std::string> what_is_lost(const CameraTrack& track, const CameraLimits& limits);

/// Pose of a camera whose axes are x right, y up, z backward (OpenGL, glTF, USD, Nuke) in Matchlight's z-up world.
RigidTransform world_from_gl_camera(const RigidTransform& camera_from_world);
/// A pose given in the z-up world, in the y-up one of glTF and Nuke: (x, y, z) → (x, z, −y).
RigidTransform in_y_up_world(const RigidTransform& world_from_thing);

}  // namespace matchlight
