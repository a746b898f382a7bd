// Spheres that let light through: peeled off layer by layer from the front, as far as it can be seen.
//
// Each layer is found behind the one before (Everitt 2001, "Interactive Order-Independent Transparency") or taken from
// lists of all that each pixel meets (render/sphere_lists.h), lit, and put under what is there. A pixel that lets no
// more than `residual` through is left alone, and peeling ends where no pixel is left; its error is at most what the
// residual lets through (render/transparency_bound.h). The exact composite in double precision is
// report/transparency_reference.h.
#pragma once

#include <functional>
#include <vector>

#include "gl/framebuffer.h"
#include "render/sphere_dual_peeling.h"
#include "render/sphere_lists.h"
#include "render/sphere_sets.h"
#include "scene/scene_file.h"

namespace matchlight {

class SpherePeeling {
public:
    explicit SpherePeeling(ShaderLibrary& shaders) : shaders_(shaders), lists_(shaders), dual_(shaders) {}

    struct Peeled {
        SphereSets& sets;
        std::span<const PlacedSpheres> placed;
        int width = 0, height = 0;
        const Texture2D& opaque_depth;  // what lies behind is hidden; of a size that holds the picture
        double residual = 0;            // transmittance
        int most_layers = 0;
        /// Lists or a way of peeling. Lists that no buffer holds are made for fewer rows at a time.
        TransparencyMethod method = TransparencyMethod::lists;
        /// Draws the layer's light, premultiplied, with its depth, into what is bound.
        std::function<void(const SeenSpheres&)> light;
        /// SphereLists::Gathered; of method `lists` alone.
        std::function<void(bool counts)> draw_others = {};
    };
    /// Returns the number of layers.
    int peel(const Peeled& peeled);

    /// Premultiplied light of all layers, alpha what they cover; RGBA32F. Until the next peel().
    const Texture2D& light() const { return light_; }
    /// near_m / z of the first layer, 0 where there is none.
    const Texture2D& first_depth_share() const { return first_depth_; }
    SphereLists& lists() { return lists_; }
    /// That no list holds: they lack what `draw_others` draws.
    const std::vector<Region>& unlisted_rows() const { return unlisted_rows_; }

private:
    /// The rows' next layer; each call one behind the other.
    using NextLayer = std::function<SeenSpheres(int layer)>;
    void fit(const Texture2D& opaque_depth);
    int peel_both_ends(const Peeled& peeled);
    int peel_rows(const Peeled& peeled, int first_row, int rows, const NextLayer& next_layer);
    void keep_first_depth(const SeenSpheres& layer, const Region& rows);

    ShaderLibrary& shaders_;
    Texture2D light_, first_depth_;
    Texture2D light_behind_;  // from the back
    SphereLists lists_;
    SphereDualPeeling dual_;
    std::vector<Region> unlisted_rows_;
    int listed_rows_ = 0;  // that lists held last
    Framebuffer target_, target_behind_;
    FullScreenTriangle triangle_;
    GLuint target_depth_ = 0;  // what the target holds besides
};

}  // namespace matchlight
