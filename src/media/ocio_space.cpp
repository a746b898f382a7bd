// A camera's colour space by its name in an OpenColorIO config, taken apart into a curve a channel and primaries.
#include "media/ocio_space.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/LU>
#include <OpenImageIO/color.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int intervals = 1024;

/// The conversion of the config, to linear light of Rec.709.
class Conversion {
public:
    Conversion(OIIO::ColorConfig& config, const fs::path& reported, const std::string& space) {
        const std::string target = interchange(config, reported);
        processor_ = config.createColorProcessor(space, target);
        if (processor_) return;
        const std::string cause = config.geterror();
        const std::vector<std::string> names = config.getColorSpaceNames();
        if (std::ranges::find(names, space) != names.end()) {
            throw InputError(reported, fmt::format("gives no way from '{}' to '{}' ({})", space, target, cause),
                             "see whether the files that it names are beside it");
        }
        const std::size_t listed = std::min<std::size_t>(names.size(), 12);
        throw InputError(
            reported, fmt::format("has no colour space '{}'", printable(space)),
            fmt::format("it has {}: {}{}", names.size(), fmt::join(names.begin(), names.begin() + listed, ", "),
                        listed < names.size() ? ", …" : ""));
    }

    Vector3d operator()(const Vector3d& code) const {
        std::array<float, 3> rgb{static_cast<float>(code[0]), static_cast<float>(code[1]), static_cast<float>(code[2])};
        processor_->apply(rgb.data(), 1, 1, 3, sizeof(float), sizeof(rgb), sizeof(rgb));
        return rec709_from_target_ * Vector3d(rgb[0], rgb[1], rgb[2]);
    }

private:
    /// A space of the config whose light is known, and the way from it.
    std::string interchange(const OIIO::ColorConfig& config, const fs::path& reported) {
        rec709_from_target_ = rec709_from_aces2065();
        const char* const aces = config.getColorSpaceNameByRole("aces_interchange");
        if (aces != nullptr && *aces != '\0') return aces;
        const std::vector<std::string> names = config.getColorSpaceNames();
        const auto has = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
        for (const char* name : {"ACES2065-1", "ACES - ACES2065-1", "aces2065_1"}) {
            if (has(name)) return name;
        }
        rec709_from_target_.setIdentity();
        for (const char* name : {"Linear Rec.709 (sRGB)", "Linear Rec.709", "lin_rec709", "lin_rec709_scene",
                                 "Utility - Linear - sRGB", "Utility - Linear - Rec.709", "lin_srgb"}) {
            if (has(name)) return name;
        }
        throw InputError(reported, "names no scene-linear space that is known",
                         "give it the role aces_interchange, or a space ACES2065-1 or lin_rec709");
    }

    OIIO::ColorProcessorHandle processor_;
    Matrix3d rec709_from_target_;
};

fs::path config_of(const fs::path& given) {
    if (!given.empty()) return given;
    const char* const named = std::getenv("OCIO");
    if (named != nullptr && *named != '\0') return named;
    throw InputError({}, "ocio_space is given, but no OpenColorIO config",
                     "give ocio_config in [footage], or name one by the environment's OCIO");
}

}  // namespace

OcioSpace ocio_space(const fs::path& given, const std::string& space) {
    const fs::path path = config_of(given);
    OIIO::ColorConfig config(path.string());
    if (config.has_error()) {
        throw InputError(path, fmt::format("is no OpenColorIO config ({})", config.geterror()));
    }
    const Conversion light_of(config, path, space);
    const auto refuse = [&](const std::string& cause) {
        throw InputError(path, fmt::format("the space '{}' {}", printable(space), cause),
                         "name the camera's own log or gamma space, a curve and a matrix");
    };

    // Each channel's own way through colour, and how far along it each code lies.
    const Vector3d black = light_of(Vector3d::Zero());
    Matrix3d ways;
    for (int c = 0; c < 3; ++c) ways.col(c) = light_of(Vector3d::Unit(c)) - black;
    if (!ways.allFinite() || !(std::abs(ways.determinant()) > 1e-9 * std::pow(ways.norm(), 3))) {
        refuse("keeps too little of the colour");
    }
    const Vector3d offset = ways.inverse() * black;
    // So scaled that grey stays grey, and the brightest grey is 1.
    const Vector3d white = light_of(Vector3d::Ones());
    const Vector3d share = ways.inverse() * Vector3d::Constant(white.mean());
    if (!(share.minCoeff() > 0)) refuse("has primaries that make no white");

    OcioSpace result;
    for (int i = 0; i <= intervals; ++i) result.codes.push_back(static_cast<double>(i) / intervals);
    for (int c = 0; c < 3; ++c) {
        std::vector<double>& curve = result.linear[static_cast<std::size_t>(c)];
        for (const double code : result.codes) {
            const Vector3d along = light_of(code * Vector3d::Unit(c)) - black;
            curve.push_back((along.dot(ways.col(c)) / ways.col(c).squaredNorm() + offset[c]) / share[c]);
            if (curve.size() > 1 && !(curve.back() > curve[curve.size() - 2])) refuse("does not grow with its codes");
        }
    }
    const Matrix3d rec709_from_space = ways * share.asDiagonal() / white.mean();
    result.primaries = Primaries(rec709_from_space, space);

    // Does it hold for colours that were not asked for? In steps of a quarter, on codes of the table.
    for (int i = 0; i < 125; ++i) {
        const std::array<int, 3> at{i % 5 * intervals / 4, i / 5 % 5 * intervals / 4, i / 25 * intervals / 4};
        Vector3d code, parts;
        for (int c = 0; c < 3; ++c) {
            const auto channel = static_cast<std::size_t>(c);
            code[c] = result.codes[static_cast<std::size_t>(at[channel])];
            parts[c] = result.linear[channel][static_cast<std::size_t>(at[channel])];
        }
        const Vector3d wanted = light_of(code) / white.mean();
        const double error = (rec709_from_space * parts - wanted).norm();
        if (!(error <= 1e-3 * (wanted.norm() + 1e-2))) refuse("is not a curve for each channel and a matrix");
    }
    return result;
}

}  // namespace matchlight
