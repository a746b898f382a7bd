// The plate and the virtual layer become one picture: real light, dimmed by the shadow, under the objects, back in the
// camera's code values, with what the camera's effects spill.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/thin_lens.h"
#include "core/image.h"
#include "core/primaries.h"
#include "core/transforms.h"
#include "gl/shader_library.h"
#include "render/effects/contact_shadow.h"
#include "render/effects/grain.h"
#include "render/effects/surface_reflection.h"
#include "render/frame_light.h"
#include "render/graph.h"
#include "render/virtual_layer.h"

namespace matchlight {

/// How the camera saw in this frame.
struct FrameOptics {
    RigidTransform camera_from_world = RigidTransform::Identity();
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();  // plate light of unit probe light: 2^ev · white balance
    std::array<double, 2> vignette{};                // gain = 1 + v0 r² + v1 r⁴, r = 1 at the corner
    int frame_width = 0, frame_height = 0;           // of the whole picture
    double corner_ratio = 1;                         // its corner is so much farther off than that of the vignette
    Focus focus;                                     // scale 0: all is sharp
    // Of simulated exposure control (render/effects/exposure.h).
    double plate_gain = 1;   // of the plate's own light: exposed anew
    double white_light = 0;  // plate-linear light shown as white; 0: no tone curve, and only what is touched changes
};

struct CompositeInput {
    const ImageF* plate_code = nullptr;   // RGB code values over `region`; read by run()
    Region region;                        // what the images cover
    std::vector<Region> runs;             // the parts of it to draw, in plate pixels
    const VirtualLayer* layer = nullptr;  // read by run(), after `layer_drawn`; null: nothing in view
    GraphTexture layer_drawn;             // what the layer's pass provides
    PlateLayer blurred;                   // what lens and shutter made of layer and shadow
    const ImageF* unclipped = nullptr;    // of clipped pixels, RGBA over `region`: light, how well known; read by run()
    double clipped_code = 1;              // from here on a code of the plate is clipped
    GraphTexture background;              // plate-linear RGB over the whole frame in place of a plate
    GraphTexture inverse_depth;           // 1/m of what the plate shows, over the frame; empty: not known
    const ImageF* matte = nullptr;        // over the whole frame, 1 = real and in front; read by run(); null: none
    const ContactShadow* shadow = nullptr;  // null: no shadow, which is a ratio of 1
    SurfaceReflection reflection = {};      // of the objects in the surface; empty: it mirrors none
    FrameOptics optics;
    double least_visible_loss = 0;         // a shadow that takes less leaves the pixel the plate's
    std::optional<FrameGrain> grain = {};  // with `light`, what of the plate is left is told, and nothing added
    bool light = false;                    // linear light, for effects and layers; else code values at once
    bool layers = false;                   // also what layers show; needs `light`
};

/// Textures over the input's region; what lies outside its runs is not written.
struct CompositePicture {
    GraphTexture plate;         // RGB code values
    GraphTexture code;          // RGB; a = 1 where the pixel was touched; only without `light`
    FrameLight light;           // `before` has a = 1 where the pixel was touched
    GraphTexture plate_share;   // RGB share of the plate in the light; only with `light` and grain
    GraphTexture shadow;        // RGB ratio
    GraphTexture reflection;    // RGB plate-linear light, signed; only with the input's
    GraphTexture virtual_rgba;  // premultiplied plate-linear light and alpha
    GraphTexture geometry;      // world normal and depth in metres
    GraphTexture object_id;     // 0 = nothing
};

/// The layer and the shadow on plate pixels, as lens effects take them.
struct ResolvedLayer {
    GraphTexture light;          // RGBA32F: premultiplied radiance in probe units, coverage
    GraphTexture inverse_depth;  // R32F: 1/m of what is nearest in the pixel, 0 where nothing is
};

/// What the response pass adds to a part of the frame.
struct ResponseInput {
    GraphTexture plate = {};             // RGB code values over `region`; or else
    const ImageF* plate_code = nullptr;  // the same to be uploaded; read by run()
    Region region;
    std::vector<Region> runs;
    FrameLight light = {};           // empty: the plate alone, around what objects touch
    GraphTexture spill;              // plate-linear light to add; empty: none
    double white_light = 0;          // as in FrameOptics
    double least_visible_code = 0;   // spilled light that moves no code by more leaves the pixel the plate's
    double least_visible_light = 0;  // less light than this cannot: CompositePass::least_visible_light()
    bool layers = false;
    std::optional<FrameGrain> grain = {};
    GraphTexture plate_share = {};  // of CompositePicture; empty: all the plate is left
};

struct ResponsePicture {
    GraphTexture code;    // RGB; a = 1 where the pixel was touched
    GraphTexture linear;  // plate-linear RGB and the objects' coverage; only with `layers`
    GraphTexture spill;   // how much of that RGB is spilled light; only with `layers`
};

/// Holds what no frame changes: the lens as a grid and the response as a table.
class CompositePass {
public:
    /// `lens_nodes` as LensMap has it, one node every `lens_spacing` pixels; `response` holds one row a channel, of
    /// light of the footage's primaries.
    CompositePass(ShaderLibrary& shaders, const ImageF& lens_nodes, int lens_spacing, const ImageF& response,
                  const Primaries& primaries = Primaries::rec709);

    CompositePicture add(RenderGraph& graph, const CompositeInput& input);
    /// Over `region`; of the input the layer alone counts. The same light, bit for bit, that add() composites.
    ResolvedLayer add_resolved_layer(RenderGraph& graph, const CompositeInput& input, const Region& region);
    /// RGB ratio of the shadow over `region`, 1 where none is visible: what add() composites, bit for bit.
    GraphTexture add_shadow_ratio(RenderGraph& graph, const CompositeInput& input, const Region& region);
    /// Sets the uniforms of common/lens_map.glsl, composite/layer.glsl and, but for those of the focus,
    /// effects/depth_of_field/gather_resolve.frag; takes texture units 1, 3, 9, 12 and 13.
    void set_layer(Program& program, const CompositeInput& input) const;
    /// What composite/layer.glsl is compiled with.
    static ShaderDefines layer_defines(const CompositeInput& input);
    /// Sets the uniforms of common/lens_map.glsl, effects/contact_shadow/contact_shadow.glsl and composite/shadow.glsl;
    /// takes texture units 1, 4 and 5.
    void set_surface(Program& program, const CompositeInput& input) const;
    /// Sets the uniforms of common/lens_map.glsl; takes a texture unit.
    void set_lens(Program& program, GLuint unit) const;
    /// From light to code values, with the spilled light.
    ResponsePicture add_response(RenderGraph& graph, const ResponseInput& input);

    /// Linear light of a code of a channel, in the footage's own primaries.
    double linear_from_code(float code, int channel) const;
    /// The least light that can move a code by half a step of `bit_depth`, anywhere on the response.
    double least_visible_light(int bit_depth) const;
    /// The light of the brightest code, of the channel that has most.
    double brightest_light() const;

private:
    /// Pixels of a picture that covers `covered`; read by run().
    struct Upload {
        const char* name;
        const ImageF& picture;  // one channel, three or four
        Region covered;
        Region region;
        const std::vector<Region>& runs;
    };
    static GraphTexture add_upload(RenderGraph& graph, const Upload& upload);
    void set_response(Program& program) const;
    void set_input(Program& program, const CompositeInput& input) const;

    ShaderLibrary& shaders_;
    Texture2D lens_nodes_;
    Texture2D response_;
    ImageF response_table_;
    int lens_spacing_;
    Primaries primaries_;
    Texture2D empty_, empty_id_;  // stand in for inputs that a frame does not have
};

/// The parts of a texture over `region` that lie in `runs` (plate pixels): all over the region, zero elsewhere.
ImageF read_runs(const Texture2D& texture, const Region& region, const std::vector<Region>& runs, int channels);

}  // namespace matchlight
