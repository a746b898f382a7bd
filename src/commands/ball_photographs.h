// The photographs of balls that `probe build` is given, read and merged into views of one unit.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera.h"
#include "calibration/hdr_merge.h"
#include "calibration/response.h"
#include "core/warnings.h"
#include "lighting/ball_view.h"

namespace matchlight {

/// What every view is read with.
struct BallReading {
    Camera camera;
    Response response;
    MergeOptions merge;
};

class BallPhotographs {
public:
    /// `output` is not to be one of the photographs.
    BallPhotographs(BallReading reading, std::filesystem::path output)
        : reading_(std::move(reading)), output_(std::move(output)) {}

    /// Files of a view, or folders of them: bracketed photographs, or one .exr or .hdr that is merged already, with
    /// `sigma.R` … and `clipped` where it has them, as `merge` writes. Throws InputError, also where some views are
    /// merged already and some are not: their units differ by nobody knows what.
    BallView read(const std::vector<std::string>& given, Warnings& warnings);

    /// Times which the views' values are radiance; 1 where they were merged already.
    double exposure_scale() const { return scale_.value_or(1); }
    /// Names of all files read, in their order.
    const std::vector<std::string>& sources() const { return sources_; }

private:
    BallView merged_before(const std::filesystem::path& file, Warnings& warnings) const;
    BallView merged_here(const std::vector<std::filesystem::path>& photographs, Warnings& warnings);

    BallReading reading_;
    std::filesystem::path output_;
    std::optional<double> scale_;
    std::vector<std::string> sources_;
};

}  // namespace matchlight
