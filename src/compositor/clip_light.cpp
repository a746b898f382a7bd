// One pass for each map, left out where the scene has nothing that looks at it.
#include "compositor/clip_light.h"

#include <algorithm>

#include <fmt/format.h>

#include "compositor/probe_lamps.h"
#include "lighting/octahedral_directions.h"
#include "lighting/probe.h"
#include "render/effects/bounce_light.h"
#include "render/effects/lamp_shadow.h"
#include "scene/object_motion.h"

namespace matchlight {

namespace {

/// Without a probe objects are lit evenly from everywhere; half of the light that makes code 1 keeps white paper
/// (albedo 0.8) well below clipping.
constexpr float even_light = 0.5f;

constexpr const char* cube_pass = "light/reflection cube";
constexpr const char* sphere_map_pass = "light/sphere map";
constexpr const char* contact_pass = "shadow/contact";
constexpr const char* between_pass = "shadow/between objects";
constexpr const char* lamp_pass = "shadow/of lamps";
constexpr const char* bounce_pass = "light/bounced";
constexpr const char* reflection_pass = "surface reflection";

// While something is dragged: what a tenth of a second has time for on two cores without a GPU.
constexpr int dragged_face_px = 64;
constexpr int dragged_lookups = 100'000;
ContactShadowSettings dragged(ContactShadowSettings settings) {
    settings.directions = std::min(settings.directions, 8);
    settings.resolution = std::min(settings.resolution, 128);
    return settings;
}

/// What the maps of shadows are made once for.
const char* hold_for(const Scene& scene) {
    return std::ranges::any_of(scene.objects, moves) ? "where the objects stand" : "the clip";
}

Probe even_probe(float light) {
    Probe probe;
    probe.latlong = ImageF(16, 8, 3, light);
    return probe;
}

Probe probe_of(const Scene& scene, Warnings& warnings) {
    if (lit_by_lamps_alone(scene)) return even_probe(0);
    if (!scene.probe) {
        warnings.add(scene.path.string() + ": no light probe: objects are lit evenly from everywhere");
        return even_probe(even_light);
    }
    return placed(load_probe(scene.probe->path, scene.probe->mapping, warnings), scene.probe->placement);
}

}  // namespace

ClipLight::ClipLight(ShaderLibrary& shaders, const Lit& lit, const Scene& scene, const Quality& quality,
                     Warnings& warnings)
    : shaders_(shaders),
      objects_(lit.objects),
      surfaces_(lit.surfaces),
      rays_(lit.objects.rays()),
      surface_(scene.surface),
      quality_(quality),
      shadows_hold_for_(hold_for(scene)),
      probe_(probe_of(scene, warnings)),
      surface_picture_(quality.reflection.level == ReflectionLevel::environment ? nullptr : lit.gathered_surface) {
    if (scene.probe) {
        probe_place_m_ = scene.probe->place_m;
        probe_name_ = scene.probe->path.string();
    }
    make_environment(warnings);
    make_lamps(scene, warnings);
    describe_surface();
}

void ClipLight::make_environment(Warnings& warnings) {
    EnvironmentSettings settings{.face_size = quality_.mirror_face_px, .maps_at_once = false};
    if (dragging_) {
        settings.face_size = std::min(settings.face_size, dragged_face_px);
        settings.lookups_per_level = dragged_lookups;
    }
    coarse_environment_ = dragging_;
    environment_ = std::make_unique<Environment>(shaders_, probe_, settings);
    if (environment_->clamped_values() > 0) {
        warnings.add(fmt::format("{}: {} values beyond the range of half floats are taken as 65504 in reflections",
                                 probe_name_, environment_->clamped_values()));
    }
}

void ClipLight::make_lamps(const Scene& scene, Warnings& warnings) {
    scene_lamps_ = scene.lamps;
    const bool any_classic = std::ranges::any_of(scene.objects, [](const ObjectSettings& object) {
        return object.material.shading.model != ShadingModel::physical;
    });
    if (any_classic && scene_lamps_.empty() && objects_.lamps().empty()) scene_lamps_ = lamps_of_probe(probe_);
    shading_.has_lamps = any_classic || !scene_lamps_.empty() || objects_.any_lamps();
    const std::size_t count = scene_lamps_.size() + objects_.lamps().size();
    if (count > most_lamps) {
        warnings.add(
            fmt::format("{}: {} lights with those of the models, of which the last {} are left out: {} is the most",
                        scene.path.string(), count, count - most_lamps, most_lamps));
    }
    lamps_.reset();
    if (shading_.has_lamps) place_lamps();
}

void ClipLight::place_lamps() {
    std::vector<LampSettings> lamps = scene_lamps_;
    for (const LampSettings& lamp : objects_.lamps()) {
        if (lamps.size() < most_lamps) lamps.push_back(lamp);
    }
    lamps_.emplace(lamps);
}

void ClipLight::set_scene(RenderGraph& graph, const Scene& scene, const SceneChange& change, Warnings& warnings) {
    shadows_hold_for_ = hold_for(scene);
    if (change.light && scene.probe) {
        probe_place_m_ = scene.probe->place_m;
        if (!unplaced_probe_) {
            Warnings unheard;  // it was read before
            unheard.set_quiet(true);
            unplaced_probe_ = load_probe(scene.probe->path, scene.probe->mapping, unheard);
        }
        probe_ = placed(*unplaced_probe_, scene.probe->placement);
        object_light_.reset();
        make_environment(warnings);
        graph.forget_kept(cube_pass);
        graph.forget_kept(sphere_map_pass);
    }
    if (change.light) make_lamps(scene, warnings);
    if (change.surface) surface_ = scene.surface;
    if (change.light || change.surface) surface_lights_.clear();
    // A share of the light that is lost does not depend on how bright the light is; what it is after rounding waits
    // until the hand rests.
    const bool hold = dragging_ && change.brightness && !lamps_ && !change.casting && !change.surface;
    if (hold) coarse_shadows_ = true;
    if (!change.shadows() || hold) return;
    // Where nothing casts any more, no pass would say so.
    contact_shadow_.reset();
    cast_shadow_.reset();
    shadow_has_bounce_ = false;
    forget_shadows(graph, true);
}

bool ClipLight::set_dragging(RenderGraph& graph, bool dragging, Warnings& warnings) {
    dragging_ = dragging;
    if (dragging_ || (!coarse_environment_ && !coarse_shadows_)) return false;
    if (coarse_environment_) {
        make_environment(warnings);
        graph.forget_kept(cube_pass);
        graph.forget_kept(sphere_map_pass);
    }
    forget_shadows(graph, true);
    return true;
}

ShadowCasters ClipLight::casters() {
    ShadowCasters casters{surfaces_.shadow_caster_bounds_m(),
                          [this](Program& program) { surfaces_.draw_shadow_casters(program); }};
    if (surfaces_.any_spheres()) {
        casters.cast_spheres = [this](const SphereCast& cast) { surfaces_.cast_shadow_spheres(cast); };
    }
    return casters;
}

ShadowCasters ClipLight::real_casters() {
    return {surfaces_.real_caster_bounds_m(), [this](Program& program) { surfaces_.draw_real_casters(program); }};
}

ShaderDefines ClipLight::ray_defines() const {
    ShaderDefines defines = shadow_defines();
    if (rays_ != nullptr && rays_->has_spheres()) defines["RAY_SPHERES"] = "1";
    return defines;
}

void ClipLight::describe_surface() {
    shading_.shows_surface = surface_picture_.present();
    shading_.traces_rays = rays_ != nullptr && !rays_->empty();
    shading_.pairs_maps = quality_.object_shadow.octahedron_divisions.has_value();
    shading_.bind = [this](Program& program) {
        bind_shading(program);
        if (!shading_.traces_rays) return;
        rays_->bind(program);
        program.set("lobe_rays", quality_.reflection.lobe_rays);
        program.set("ray_bounces", quality_.reflection.bounces);
    };
}

void ClipLight::bind_shading(Program& program) const {
    // The probe shows the surface from its own place; without that place the surface is taken as far away.
    const bool is_near = surface_.present && probe_place_m_ && probe_place_m_->z() > surface_.z_m;
    const Eigen::Vector3d place_m = is_near ? *probe_place_m_ : Eigen::Vector3d::Zero();
    constexpr GLuint unit = SurfaceShading::first_free_unit;
    constexpr GLuint picture_unit = unit + 4;  // after what shadows between objects take
    surface_picture_.bind(program, picture_unit);
    program.set("surface_z_m", surface_.z_m);
    program.set("surface_is_near", is_near);
    program.set("probe_place_m", Eigen::Vector3f(place_m.cast<float>()));
    if (lamps_) {
        lamps_->bind(program);
        program.set("surface_hides_lamps", surface_.present);
    }
    program.set("objects_shade", object_shadow_.has_value());
    if (object_shadow_) object_shadow_->bind(program, SurfaceShading::object_shadow_unit);
    if (real_shadow_) real_shadow_->bind_as_real(program, SurfaceShading::object_shadow_unit + 1);
    program.set("surface_shadow_present", contact_shadow_.has_value());
    if (contact_shadow_) {
        contact_shadow_->bind(program, unit);
    } else {
        program.bind_texture("shadow_fine", unit, no_shadow_);
        program.bind_texture("shadow_far", unit + 1, no_shadow_);
    }
}

std::optional<WatchedTexture> ClipLight::map_of(const std::string& pass) const {
    if (pass != contact_pass || !contact_shadow_) return std::nullopt;
    const Texture2D& loss = contact_shadow_->far.loss;
    return WatchedTexture{pass, {.format = GL_RGBA32F, .region = loss.bounds()}, loss.read<float>(loss.bounds(), 4)};
}

std::optional<MirrorReach> ClipLight::mirror_reach() const {
    const Eigen::AlignedBox3d objects_m = surfaces_.virtual_bounds_m();
    if (surface_.reflection == 0 || !surface_.present || !shading_.traces_rays || objects_m.isEmpty())
        return std::nullopt;
    return MirrorReach{objects_m, surface_.z_m, lobe_reach(surface_.reflection_roughness)};
}

SurfaceReflection ClipLight::add_reflection(RenderGraph& graph, const MirrorView& view) const {
    const auto leave_out = [&](const char* why) {
        graph.leave_out(reflection_pass, why);
        return SurfaceReflection{};
    };
    if ((surface_.reflection == 0 || !surface_.present) && graph.leaves_out())
        return leave_out("the scene's surface mirrors no objects");
    if (quality_.reflection.level != ReflectionLevel::rays) return leave_out("this quality level traces no rays");
    const Eigen::AlignedBox3d objects_m = surfaces_.virtual_bounds_m();
    if (!shading_.traces_rays || objects_m.isEmpty()) return leave_out("rays meet no object");
    return add_surface_reflection(graph, shaders_,
                                  {.reflectance = surface_.present ? surface_.reflection : 0,
                                   .roughness = surface_.reflection_roughness,
                                   .rays = quality_.reflection.surface_rays},
                                  {.objects_m = objects_m,
                                   .z_m = surface_.z_m,
                                   .camera_from_world = view.camera_from_world,
                                   .region = view.region,
                                   .runs = view.runs,
                                   .light = view.light,
                                   .defines = ray_defines(),
                                   .bind_light =
                                       [this](Program& program) {
                                           environment_->bind(program);
                                           shading_.bind(program);
                                       },
                                   .bind_lens = view.bind_lens});
}

std::vector<PassInput> ClipLight::add_passes(RenderGraph& graph) {
    std::vector<PassInput> inputs;
    add_environment(graph, inputs);
    add_shadows(graph, inputs);
    add_lamps(graph, inputs);
    add_bounces(graph, inputs);
    return inputs;
}

void ClipLight::add_environment(RenderGraph& graph, std::vector<PassInput>& inputs) {
    const auto add = [&](const char* name, ReflectionForm form, const char* nobody,
                         void (Environment::*make)(ShaderLibrary&)) {
        if (!surfaces_.any_reflects(form) && graph.leaves_out()) return graph.leave_out(name, nobody);
        const GraphTexture map = graph.import(nullptr, {.format = GL_NONE, .region = {}});
        graph.add_pass({.name = name, .writes = {}, .provides = {map}, .once = true, .draw = [this, make](PassRun&) {
                            (environment_.get()->*make)(shaders_);
                        }});
        inputs.push_back({map});
    };
    add(cube_pass, ReflectionForm::cube, "no object reflects by it", &Environment::make_cube);
    add(sphere_map_pass, ReflectionForm::sphere_map, "no object reflects by it", &Environment::make_sphere_map);
}

void ClipLight::forget_shadows(RenderGraph& graph, bool casters) {
    if (casters) {
        if (lamps_ && objects_.any_lamps()) place_lamps();
        graph.forget_kept(contact_pass);
        graph.forget_kept(lamp_pass);
    }
    coarse_shadows_ = dragging_;
    if (dragging_) return;
    graph.forget_kept(between_pass);
    graph.forget_kept(bounce_pass);
}

void ClipLight::add_shadows(RenderGraph& graph, std::vector<PassInput>& inputs) {
    const bool anything_casts = !surfaces_.shadow_caster_bounds_m().isEmpty();
    std::vector<PassInput> contact_input;
    if (!surface_.present || !surface_.shadow) {
        graph.leave_out(contact_pass, "the scene's surface catches no shadow");
    } else if (!anything_casts && !lamps_ && graph.leaves_out()) {
        graph.leave_out(contact_pass, "no object casts");
    } else {
        const GraphTexture map = graph.import(nullptr, {.format = GL_NONE, .region = {}});
        graph.add_pass({.name = contact_pass,
                        .writes = {},
                        .provides = {map},
                        .once = true,
                        .once_for = shadows_hold_for_,
                        .draw = [this](PassRun&) {
                            const ContactShadowSettings& settings =
                                dragging_ ? dragged(quality_.shadow) : quality_.shadow;
                            make_surface_shadow(settings);
                            cast_shadow_.reset();
                            if (contact_shadow_ && bounces()) cast_shadow_ = contact_shadow_->copy();
                            shadow_has_bounce_ = false;
                        }});
        contact_input.push_back({map});
        inputs.push_back({map});
    }
    if (!quality_.object_shadow.any()) return graph.leave_out(between_pass, "this quality level has none");
    const bool anything_shades = anything_casts || !surfaces_.real_caster_bounds_m().isEmpty();
    if (!anything_shades && graph.leaves_out()) return graph.leave_out(between_pass, "no object casts");
    const GraphTexture baked = graph.import(nullptr, {.format = GL_NONE, .region = {}});
    graph.add_pass({.name = between_pass,
                    .reads = contact_input,
                    .provides = {baked},
                    .once = true,
                    .once_for = shadows_hold_for_,
                    .draw = [this](PassRun&) { bake_object_shadow(); }});
    inputs.push_back({baked});
}

void ClipLight::add_lamps(RenderGraph& graph, std::vector<PassInput>& inputs) {
    if (!lamps_) return graph.leave_out(lamp_pass, "the scene has no analytic lights");
    const GraphTexture maps = graph.import(nullptr, {.format = GL_NONE, .region = {}});
    graph.add_pass(
        {.name = lamp_pass, .provides = {maps}, .once = true, .once_for = shadows_hold_for_, .draw = [this](PassRun&) {
             const bool rays_meet_all =
                 shading_.traces_rays && quality_.lamps.rays > 0 && surfaces_.rays_meet_all_casters();
             lamps_->draw_maps(shaders_, casters(), quality_.lamps, !rays_meet_all);
         }});
    inputs.push_back({maps});
}

void ClipLight::make_surface_shadow(const ContactShadowSettings& settings) {
    SurfaceLight surface = surface_light(settings.directions);
    const SurfaceLamps lamps{.lamps = lamps_ ? &*lamps_ : nullptr,
                             .probe_irradiance = irradiance(probe_, Eigen::Vector3d::UnitZ())};
    if (lamps_)
        surface.lamp_reach_m =
            lamp_shadow_reach(surfaces_.shadow_caster_bounds_m(), surface_.z_m, lamps, settings.lost_share);
    contact_shadow_ = make_contact_shadow(shaders_, casters(), surface, settings);
    if (!lamps_) return;
    const int points = dragging_ ? 1 : quality_.lamps.surface_points;
    contact_shadow_ = with_lamps(shaders_, std::move(contact_shadow_), casters(), surface_.z_m, lamps, points);
}

// Objects that move change nothing of these, and to find them the whole probe is summed up.
const SurfaceLight& ClipLight::surface_light(int directions) {
    const auto found = surface_lights_.find(directions);
    if (found != surface_lights_.end()) return found->second;
    return surface_lights_.emplace(directions, make_surface_light(probe_, surface_.z_m, directions)).first->second;
}

const std::vector<DirectionalSample>& ClipLight::object_light() {
    if (object_light_) return *object_light_;
    const std::optional<int>& divisions = quality_.object_shadow.octahedron_divisions;
    object_light_ = divisions ? sample_octahedrally(probe_, *divisions)
                              : sample_directions(probe_, quality_.object_shadow.directions, -1, false);
    return *object_light_;
}

bool ClipLight::bounces() const {
    return shading_.traces_rays && quality_.bounce.rays > 0;
}

/// What bounced before, from objects that stood elsewhere, is not in it.
void ClipLight::restore_cast_shadow() {
    if (cast_shadow_ && shadow_has_bounce_) contact_shadow_ = cast_shadow_->copy();
    shadow_has_bounce_ = false;
}

void ClipLight::bake_object_shadow() {
    restore_cast_shadow();
    has_visibility_ = false;
    object_shadow_.reset();
    real_shadow_.reset();
    const std::vector<DirectionalSample>& samples = object_light();
    const bool reals_cast = !surfaces_.real_caster_bounds_m().isEmpty();
    if (samples.empty() || (surfaces_.shadow_caster_bounds_m().isEmpty() && !reals_cast)) return;
    object_shadow_.emplace(shaders_, casters(), samples, quality_.object_shadow);
    if (reals_cast) real_shadow_.emplace(shaders_, real_casters(), samples, quality_.object_shadow);
    ShaderDefines defines = shadow_defines();
    if (shading_.pairs_maps) defines["PAIRED_MAPS"] = "1";
    Program& bake = shaders_.compute("effects/object_shadow/bake.comp", defines);
    bake.use();
    environment_->bind(bake);
    bind_shading(bake);
    surfaces_.bake_visibility(bake);
    has_visibility_ = true;
    if (surfaces_.any_spheres()) return;
    // Vertices keep what they need of it.
    object_shadow_.reset();
    real_shadow_.reset();
}

void ClipLight::add_bounces(RenderGraph& graph, std::vector<PassInput>& inputs) {
    if (!shading_.traces_rays) {
        const bool traces = quality_.reflection.level == ReflectionLevel::rays;
        return graph.leave_out(bounce_pass, traces ? "rays meet no object" : "this quality level traces no rays");
    }
    const GraphTexture bounced = graph.import(nullptr, {.format = GL_NONE, .region = {}});
    graph.add_pass({.name = bounce_pass,
                    .reads = inputs,
                    .writes = {},
                    .provides = {bounced},
                    .once = true,
                    .once_for = shadows_hold_for_,
                    .draw = [this](PassRun&) { bounce_light(); }});
    inputs.push_back({bounced});
}

void ClipLight::bounce_light() {
    restore_cast_shadow();
    const BouncingObjects objects{.surfaces = surfaces_,
                                  .rays = *rays_,
                                  .bind_light =
                                      [this](Program& program) {
                                          environment_->bind(program);
                                          bind_shading(program);
                                      },
                                  .has_visibility = has_visibility_,
                                  .defines = ray_defines()};
    bounce_between_objects(shaders_, objects, quality_.bounce);
    if (!contact_shadow_ || !bounces()) return;
    bounce_to_surface(
        shaders_, objects, *contact_shadow_, bounce_reach(surfaces_.shadow_caster_bounds_m(), surface_.z_m),
        contact_shadow_->lamps ? contact_shadow_->lamps->reference() : irradiance(probe_, Eigen::Vector3d::UnitZ()),
        quality_.bounce);
    shadow_has_bounce_ = true;
}

}  // namespace matchlight
