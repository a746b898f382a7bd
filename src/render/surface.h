// Draws the virtual objects under the probe's light: what the camera would see of them, and nothing else.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "render/environment.h"
#include "render/sphere_blending.h"
#include "render/sphere_edges.h"
#include "render/sphere_peeling.h"
#include "render/sphere_sets.h"
#include "scene/model.h"
#include "scene/scene_file.h"

namespace matchlight {

struct SurfaceMaterial;
struct SurfacePictures;
class ObjectOutlines;

/// An object that is seen from elsewhere than the rest, with the same depths.
struct ObjectView {
    std::size_t object = 0;
    Eigen::Matrix4d clip_from_world = Eigen::Matrix4d::Identity();
    Eigen::Vector3d eye_world_m = Eigen::Vector3d::Zero();
};

/// An object that is blurred as if the lens were focused elsewhere, or not at all.
struct ObjectFocus {
    std::size_t object = 0;
    std::optional<double> distance_m;  // absent: sharp
};

/// A lens that blurs the picture after it is drawn, where the depth alone does not tell how wide.
struct SurfaceLens {
    Focus focus;
    CocRange range;                                           // what the blur is made for
    Eigen::Vector3d right_world_m = Eigen::Vector3d::Zero();  // its diameter along the picture's x and y
    Eigen::Vector3d down_world_m = Eigen::Vector3d::Zero();
    double layer_density = 1;         // pixels along a plate pixel
    bool focuses_reflections = true;  // at the depth of the virtual image; else at that of the surface
    bool parts_transparent = false;   // draw() leaves blended meshes to draw_transparent()
    std::span<const ObjectFocus> apart = {};
};

/// How far the footage's own things are, on the plate's pixels: they hide what is virtual behind them.
struct RealDepth {
    std::function<void(Program&)>
        bind;  // sets the uniforms of surface/real_depth.vert and .frag; units from first_unit
    Eigen::Matrix4d clip_from_camera = Eigen::Matrix4d::Identity();
    Region cells;                             // of the lens' grid, where the view looks
    static constexpr GLuint first_unit = 24;  // beyond those of the light's programs
};

/// What one draw sees. `clip_from_world` is clip_from_camera (core/transforms.h) of the drawn region times
/// camera_from_world: reversed z, y up, clip w = metres along the camera's z.
struct SurfaceView {
    Eigen::Matrix4d clip_from_world = Eigen::Matrix4d::Identity();
    Eigen::Vector3d eye_world_m = Eigen::Vector3d::Zero();
    int width = 0, height = 0;  // pixels of the picture (of the supersampled one, if it is)
    double density = 1;         // pixels along a plate pixel, which outlines are measured in
    int samples = 4;            // a pixel, for edges; 1 is none; more than the driver has becomes what it has
    std::span<const ObjectView> apart = {};
    std::optional<SurfaceLens> lens = {};  // of draws without multisampling
    /// Real things in front count as covered, in black, so that what blurs the picture takes them as the surfaces they
    /// are; SurfacePicture::coverage then tells them from virtual ones. False: they leave the picture empty.
    bool parts_coverage = false;
    const RealDepth* real_depth = nullptr;  // null: not known
    double sphere_detail_px = 0;            // SphereDetail::radius_px of opaque spheres
    int halo_step_px = 1;                   // between the places that halos look at
    int sphere_edge_places = 0;  // along a pixel's side (render/sphere_edges.h); less than 2: pixels' middles tell
};

/// How the view sees an object: apart or as the rest.
ObjectView view_of_object(const SurfaceView& view, std::size_t object);

/// Points into textures of the renderer that may be larger than the view and hold until its next draw: the picture is
/// their top-left width × height. Layers are null unless drawn.
struct SurfacePicture {
    int width = 0, height = 0;
    const Texture2D* color = nullptr;  // premultiplied radiance in probe units, coverage in alpha; RGBA16F
    /// near_m / z, 0 where nothing opaque is: the depth buffer; null where the picture is multisampled.
    const Texture2D* depth_share = nullptr;
    /// near_m / z of points that the lens would blur as much as what is seen, times their coverage; 0 where nothing
    /// is. R32F; null unless the view has a lens.
    const Texture2D* focus_share = nullptr;
    /// rgb = coverage of virtual things, a = that of `color`; RGBA16F; null unless the view parts it.
    const Texture2D* coverage = nullptr;
    const Texture2D* depth_m = nullptr;    // along the camera's z, 0 where nothing is; R32F
    const Texture2D* normal = nullptr;     // world, unit length, w = 1; zero where nothing is; RGBA16F
    const Texture2D* object_id = nullptr;  // 0 where nothing is; R32UI
};

/// What a matte can be asked for: what one object has of one material.
struct SurfacePart {
    std::size_t object = 0;  // its index
    std::string material;    // its name in the model; empty where it has none
};

/// Of what draw_ways() draws, each with a picture of its own.
enum class WayPicture { shutter, to_next, to_previous };

/// Where an object's points are when the shutter opens and closes.
struct ObjectWay {
    Eigen::Matrix4d opening_camera_from_model = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d closing_camera_from_model = Eigen::Matrix4d::Identity();
    bool deforms = false;  // its vertices are where set_way_end() put them then
};

enum class WayEnd { opening, closing };

/// An object as it is added; `model` and `pictures` are only read while adding.
struct SurfaceObject {
    const Model* model = nullptr;
    Eigen::Matrix4d world_from_model = Eigen::Matrix4d::Identity();
    MaterialOverride material = {};
    ReflectionForm reflection = ReflectionForm::cube;
    int id = 1;  // in the object-id layer; 0 is kept for the background
    bool casts_shadow = true;
    bool is_holdout = false;                    // a real thing's shape
    SphereHalo halo = {};                       // of a set of opaque spheres
    const SurfacePictures* pictures = nullptr;  // what the scene lays on it; null: nothing
};

/// Sets what other passes bring into the shading of surfaces: the uniforms of common/visibility.glsl. Texture units
/// from `first_free_unit` are theirs. Empty: no real surface, no shadow.
struct SurfaceShading {
    std::function<void(Program&)> bind;
    bool shows_surface = false;     // reflections show the surface's picture: also those of common/near_light.glsl
    bool traces_rays = false;       // reflections meet objects: also those of common/object_light.glsl
    bool pairs_maps = false;        // that shade spheres: opposite directions share one
    bool fades_with_depth = false;  // also those of surface/depth_cue.glsl
    bool has_lamps = false;         // also those of common/lamps.glsl and common/lamp_shadow.glsl
    static constexpr GLuint first_free_unit = 8;
    /// Of the maps that shade spheres, which keep no light at vertices: the uniforms of
    /// effects/object_shadow/object_shadow.glsl, where `objects_shade` is set; two units.
    static constexpr GLuint object_shadow_unit = first_free_unit + 2;
};

/// The geometry of one mesh as it stands in the world.
struct PlacedMesh {
    std::vector<Eigen::Vector3d> positions_m, normals;
    std::vector<std::uint32_t> indices;  // of triangles
    std::size_t object = 0;              // its index
    bool casts_shadow = true;
    bool is_holdout = false;
    double reflectance = 0;  // of white light, as SurfaceMaterial has it
};

/// Objects on the GPU. Opaque and masked meshes are drawn first, then the blended ones from back to front by the
/// distance of their centres, or in the order of each pixel (lists_meshes()). Each draw sets the depth, blend and cull
/// state it needs and leaves depth test, blending and culling off.
class SurfaceRenderer {
public:
    explicit SurfaceRenderer(ShaderLibrary& shaders);
    ~SurfaceRenderer();

    /// Uploads the model; returns the object's index. Throws InputError for textures larger than the driver takes.
    std::size_t add_object(const SurfaceObject& object);
    /// The same of a set of spheres in place of the model, which is null; its placement has one scale, and it is no
    /// holdout. `set` is only read while adding.
    std::size_t add_spheres(const SurfaceObject& object, const SphereSet& set);
    bool any_spheres() const;
    /// What light spheres that are peeled may let through unseen, and how many layers are the most.
    void set_peeling(double residual, int most_layers, TransparencyMethod method = TransparencyMethod::lists);
    int peeled_layers() const { return peeled_layers_; }  // by the last draw
    /// How they are drawn: what is passed over, for reports and tests. Null where there are none.
    SphereSets* spheres() { return spheres_.get(); }
    SphereLists& sphere_lists() { return peeling_.lists(); }
    void place_object(std::size_t index, const Eigen::Matrix4d& world_from_model);
    /// Moves the vertices of the meshes of an object's model that are bound to a rig; `meshes` are all of them.
    void deform_object(std::size_t index, std::span<const ModelMesh> meshes);
    /// How often that happened: what was read back before is no longer so.
    std::size_t deformations() const { return deformations_; }
    /// Where they are at the end of a way, for draw_ways().
    void set_way_end(std::size_t index, std::span<const ModelMesh> meshes, WayEnd end);
    /// Other factors of an object's materials. False, and nothing is changed, where they need a texture of the model
    /// that was not uploaded, because the ones before stood in its place.
    bool set_material(std::size_t index, const MaterialOverride& material);
    /// Of all materials of all objects: what they return to the real surface in their shadows.
    std::vector<float> reflectances() const;
    void set_reflection(std::size_t index, ReflectionForm form);
    void set_casts_shadow(std::size_t index, bool casts);
    void set_halo(std::size_t index, const SphereHalo& halo);
    const Eigen::Matrix4d& world_from_model(std::size_t index) const;
    std::size_t object_count() const;
    bool any_reflects(ReflectionForm form) const;
    bool any_blends() const;
    /// Whether something lets light through that it bends or spreads.
    bool any_transmits() const;
    /// Holdouts are never seen: they hide what is behind them.
    bool is_holdout(std::size_t index) const;
    bool any_holdout() const;

    /// Box in world axes around an object, and around all of them (empty when there are none).
    Eigen::AlignedBox3d object_bounds_m(std::size_t index) const;
    /// The same of one object in its own model's axes.
    Eigen::AlignedBox3d model_bounds_m(std::size_t index) const;
    Eigen::AlignedBox3d bounds_m() const;
    /// Around all that is no holdout.
    Eigen::AlignedBox3d virtual_bounds_m() const;
    /// Around those that draw_shadow_casters draws, and those that draw_real_casters does.
    Eigen::AlignedBox3d shadow_caster_bounds_m() const;
    Eigen::AlignedBox3d real_caster_bounds_m() const;

    SurfacePicture draw(const Environment& environment, const SurfaceView& view, const SurfaceShading& shading = {});
    /// What draw() found hidden behind the nearest opaque surface, with its depth: the next one. The view is draw()'s,
    /// without multisampling.
    SurfacePicture draw_hidden(const Environment& environment, const SurfaceView& view,
                               const SurfaceShading& shading = {});
    /// The blended meshes, before what draw() drew last, of the same view, which has a lens.
    SurfacePicture draw_transparent(const Environment& environment, const SurfaceView& view,
                                    const SurfaceShading& shading = {});
    /// Holdouts alone, in `color` the share of their light that virtual objects leave them, premultiplied with how much
    /// of the pixel they cover. Not part of the textures that other draws reuse.
    SurfacePicture draw_holdouts(const SurfaceView& view);
    /// Depth, normal and object id, one sample a pixel; the colour of the picture is null.
    SurfacePicture draw_layers(const SurfaceView& view);

    /// How what is nearest in each pixel moves, one way for each object: normalised camera coordinates (x/z, y/z) at
    /// the shutter's closing less those at its opening, the object's id, 1/z (1/m); all 0 where nothing is. RGBA32F;
    /// the picture is the top-left part, and holds until the next call for the same one.
    const Texture2D& draw_ways(const SurfaceView& view, std::span<const ObjectWay> ways,
                               WayPicture picture = WayPicture::shutter);

    /// In the order of their numbers, which begin at 1.
    std::vector<SurfacePart> parts() const;
    /// The part that each sample sees, 0 where there is none; a blended one is seen in as many samples as it has
    /// opacity. Multisampled R32F: the samples that draw() draws of `view`, or more of them where something blends.
    const Texture2D& draw_parts(const SurfaceView& view);
    /// The ways of holdouts alone, beside draw_holdouts().
    const Texture2D& draw_holdout_ways(const SurfaceView& view, std::span<const ObjectWay> ways);

    /// Runs a compute program over the vertices of every mesh, to keep what it finds of their light with them (see
    /// render/effects/object_shadow.h). Sets `world_from_model` and `normal_from_model` for each object.
    void bake_visibility(Program& program);

    /// Runs a compute program over the vertices of every mesh. Sets `world_from_model`, `normal_from_model` and
    /// `first_vertex`, the number of a mesh's first vertex among those of all meshes.
    void run_over_vertices(Program& program) const;

    /// Every mesh, read back, in the order that set_visibility() takes: for references in double precision.
    std::vector<PlacedMesh> read_meshes() const;
    /// The share of light over the hemisphere of every vertex of a mesh, instead of what was baked.
    void set_visibility(std::size_t mesh, std::span<const Eigen::Vector3f> visibility);

    /// Draws the geometry of shadow casters with the caller's program and state: position at attribute 0, uniform
    /// `world_from_model` set for each object. Blended meshes whose alpha is below a half cast none.
    void draw_shadow_casters(Program& program) const;
    /// Whether rays meet the meshes that cast shadows and no others.
    bool rays_meet_all_casters() const;
    /// Casts the sets of spheres that cast shadows.
    void cast_shadow_spheres(const SphereCast& cast) const;
    /// The same of holdouts.
    void draw_real_casters(Program& program) const;

private:
    struct Mesh;
    struct Object;
    struct Targets;

    enum class Drawn {
        light,
        opaque_light,
        listed_light,
        transparent_light,
        hidden_depth,
        hidden_light,
        layers,
        ways,
        holdouts,
        holdout_ways
    };
    /// What shaders of light are compiled with.
    static ShaderDefines view_defines(const SurfaceView& view);
    /// What draws one kind of picture.
    struct Programs {
        Program& meshes;
        Program* spheres = nullptr;  // null: none are drawn
        /// For materials that are not plain; empty: `meshes` does for them.
        std::function<Program&(const SurfaceMaterial&)> of_material = {};
        /// Takes over what is drawn so far, before the first mesh that lets it show through.
        std::function<void()> make_backdrop = {};
    };
    Programs programs(const std::string& fragment, ShaderDefines defines = {},
                      const std::function<void(Program&)>& set_up = {}) const;
    /// `drawn` with others for what moves what is seen, which passes without light need, too.
    Programs with_relief(Programs drawn, const std::string& fragment,
                         const std::function<void(Program&)>& set_up = {}) const;
    /// The programs for light, with what they read set.
    Programs light_programs(const Environment& environment, const SurfaceView& view, const SurfaceShading& shading,
                            const ShaderDefines& more = {}) const;
    static ShaderDefines light_defines(const SurfaceView& view, const SurfaceShading& shading);
    static void set_light(Program& program, const Environment& environment, const SurfaceView& view,
                          const SurfaceShading& shading);
    using PlaceMore = std::function<void(Program&, std::size_t)>;
    /// Sets what a program needs to know of an object; `place_more` what else it needs, by the object's index.
    void place(Program& program, const SurfaceView& view, const Object& object, const PlaceMore& place_more) const;
    void draw_objects(const Programs& programs, const SurfaceView& view, Drawn drawn,
                      const PlaceMore& place_more = {}) const;
    /// Finds which spheres the view sees, for draw_seen_spheres(); with `nearer_share` those behind that depth.
    enum class SphereKind { opaque, all };
    void see_spheres(const SurfaceView& view, SphereKind kind, const Texture2D* nearer_share = nullptr);
    std::vector<PlacedSpheres> placed_spheres(const SurfaceView& view,
                                              const std::function<bool(const Object&)>& of) const;
    bool any_spheres_blend() const;
    bool has_classic_spheres() const;
    bool any_halos() const;
    /// Whether blended meshes are put together with spheres, or with each other where their boxes meet, in the order of
    /// each pixel, and not in that of their middles.
    bool lists_meshes(const SurfaceView& view) const;
    /// For SphereLists; empty where they are not.
    std::function<void(bool counts)> listing(const Environment& environment, const SurfaceView& view,
                                             const SurfaceShading& shading) const;
    /// Puts spheres that let light through, and meshes that are listed, before the depth of `target` over it.
    void draw_in_order(const Environment& environment, const SurfaceView& view, const SurfaceShading& shading,
                       const Framebuffer& target);
    void draw_seen_spheres(Program& program, const SurfaceView& view, const PlaceMore& place_more) const;
    /// What draws one set of spheres needs to know of it, but for where it is seen.
    void place_spheres(Program& program, const SurfaceView& view, const Object& object,
                       const PlaceMore& place_more) const;
    /// Of spheres that let light through, one layer: what peel or blend made of them.
    struct SphereLayer {
        const Texture2D& light;
        const Texture2D& first_depth_share;
    };
    SphereLayer peel_spheres(const Environment& environment, const SurfaceView& view, const SurfaceShading& shading);
    SphereLayer blend_spheres(const Environment& environment, const SurfaceView& view, const SurfaceShading& shading);
    /// Mixes pixels of what draw() drew where the spheres that it saw have their edges.
    void soften_sphere_edges(const SurfaceView& view, const Texture2D& depth);
    bool softens_sphere_edges(const SurfaceView& view) const;
    /// Draws the edges of objects that have outlines over what draw() drew.
    void draw_outlines(const SurfaceView& view, const SurfaceShading& shading);
    bool casts_spheres(const Object& object) const;
    Eigen::AlignedBox3d sphere_bounds_m(const Object& object) const;
    /// What stands for real things, before all that is virtual; `program` as in draw_objects().
    void draw_real(Program& program, const SurfaceView& view, Drawn drawn, const PlaceMore& place_more) const;
    void draw_holdout_meshes(Program& program, const SurfaceView& view, Drawn drawn, const PlaceMore& place_more) const;
    void draw_real_depth(const SurfaceView& view, Drawn drawn) const;
    void draw_casters(Program& program, bool real) const;
    Eigen::AlignedBox3d caster_bounds_m(bool real) const;
    const Texture2D& draw_ways_into(Targets& targets, const SurfaceView& view, std::span<const ObjectWay> ways,
                                    WayPicture picture, Drawn drawn);
    void draw_mesh(Program& program, const SurfaceView& view, const Object& object, const Mesh& mesh) const;

    ShaderLibrary& shaders_;
    std::vector<Object> objects_;
    int vertex_count_ = 0;  // of all meshes
    std::size_t deformations_ = 0;
    std::unique_ptr<Targets> targets_;
    std::unique_ptr<Targets> holdout_targets_;
    FullScreenTriangle triangle_;  // and the cells of the lens' grid
    std::unique_ptr<SphereSets> spheres_;
    SeenSpheres seen_spheres_;
    SpherePeeling peeling_;
    SphereBlending blending_;
    SphereEdges sphere_edges_;
    std::unique_ptr<ObjectOutlines> outlines_;
    double peeling_residual_ = 1.0 / 255 / 64;  // half a code in the darkest part of the sRGB curve, and less elsewhere
    int most_peeled_layers_ = 4096;
    TransparencyMethod transparency_ = TransparencyMethod::lists;
    int peeled_layers_ = 0;
};

}  // namespace matchlight
