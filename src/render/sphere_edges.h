// How much of a pixel each sphere covers at silhouettes and where spheres meet.
//
// A picture of spheres knows what is nearest at the middles of its pixels. Where neighbours show different spheres, the
// outlines of all that the pixel and its eight neighbours show are met again at `side` × `side` places in the pixel,
// the nearest at each, and the pixel takes the light of each in that share: as many rays as a picture of `side` times
// the resolution at edges, none elsewhere, and no more light than one sample a pixel. What no pixel's middle shows is
// not known to it: spheres smaller than a pixel count as often as they are seen. The reference in double precision is
// reference_coverage (report/sphere_reference.h).
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "render/sphere_sets.h"

namespace matchlight {

/// Places along a pixel's side; a straight edge that crosses it is told to 1/12 by 6, to 1/16 by 8 (tests).
inline constexpr int most_edge_places = 16;

class SphereEdges {
public:
    explicit SphereEdges(ShaderLibrary& shaders) : shaders_(shaders) {}

    struct Picture {
        SeenSpheres seen;
        const Texture2D* depth = nullptr;         // near_m / z of what is drawn, also of what is no sphere
        std::span<const Texture2D* const> drawn;  // 1 to 3 pictures, premultiplied: they are changed
        int width = 0, height = 0;
        double near_m = 0;                                              // of the near plane
        int side = 0;                                                   // 2 to most_edge_places
        Eigen::Matrix3d camera_from_ndc = Eigen::Matrix3d::Identity();  // × (ndc, 1): a ray, 1 along the camera's z
    };
    /// `each` is called with the program that finds outlines, and draws it once for every set, with the uniforms of
    /// shaders/spheres/seen.glsl and `camera_from_model` set.
    void soften(const Picture& picture, const std::function<void(Program&)>& each);

private:
    void fit(const Picture& picture);

    ShaderLibrary& shaders_;
    Texture2D outline_;
    Framebuffer outline_target_;
    std::array<Texture2D, 3> before_;
    Framebuffer target_;
    std::vector<GLuint> target_names_;
    FullScreenTriangle triangle_;
};

/// From homogeneous ndc to camera axes (x right, y up, z forward), for a view whose rays these are; the rows of
/// `axes_from_world` are those of clip x, y and w. Its inverse's upper triangle holds focal lengths and centre.
Eigen::Matrix3d camera_from_ndc(const Eigen::Matrix3d& axes_from_world);

}  // namespace matchlight
