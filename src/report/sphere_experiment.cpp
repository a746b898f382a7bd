// Which ways of drawing are compared, set by set.
#include "report/sphere_experiment.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "report/sphere_edge_trial.h"
#include "report/sphere_halo_trial.h"
#include "report/sphere_layers.h"
#include "report/sphere_occlusion_trial.h"
#include "report/sphere_orbit.h"
#include "report/sphere_stage.h"
#include "report/sphere_trial.h"
#include "scene/sphere_caster.h"
#include "scene/sphere_file.h"
#include "scene/sphere_generate.h"

namespace matchlight {
namespace {

SphereSet set_named(const std::string& name, Warnings& warnings) {
    const auto is_named = [&](const GeneratedSet& set) { return set.name == name; };
    if (std::ranges::any_of(generated_sets(), is_named))
        return generate_sphere_set({.name = name, .seed = 1, .count = {}});
    return load_sphere_set(name, {}, warnings);
}

std::vector<ReferenceView> views_of(const SphereSet& set, const SphereOrbit& orbit, std::size_t frames, int side_px) {
    std::vector<ReferenceView> views;
    for (std::size_t frame = 0; frame < frames; ++frame) {
        const double turn = static_cast<double>(frame) / static_cast<double>(frames);
        views.push_back(orbit_view(set.bounds_m, orbit, turn, side_px));
    }
    return views;
}

/// At which the covered share is told to a sixteenth.
constexpr int checked_edge_places = 8;

SpherePart visibility_part(SphereStage& stage) {
    SpherePart part{.name = "visibility", .ways = {}};
    const auto add = [&](const char* name, const SphereVisibility& visibility) {
        part.ways.push_back({name, [&stage, visibility](const ReferenceView& view) { stage.see(view, visibility); },
                             [&stage] { return stage.drawn_cells(); }});
    };
    add("no tests", {.frustum = false, .occlusion = false});
    add("frustum", {.frustum = true, .occlusion = false});
    add("frustum, occlusion", {.frustum = true, .occlusion = true});
    return part;
}

SpherePart light_part(SphereStage& stage) {
    return {.name = "light",
            .ways = {{"seen", [&stage](const ReferenceView& view) { stage.see(view, {}); }},
                     {"probe light", [&stage](const ReferenceView& view) { stage.draw(view, {}); }},
                     {"probe light, edges",
                      [&stage](const ReferenceView& view) {
                          stage.set_edge_places(checked_edge_places);
                          stage.draw(view, {});
                          stage.set_edge_places(0);
                      }},
                     {"probe light, 66 maps", [&stage](const ReferenceView& view) {
                          stage.set_occlusion(SphereStage::Occlusion{});
                          stage.draw(view, {});
                          stage.set_occlusion({});
                      }}}};
}

/// Of sets that take seconds a frame, and of what is drawn in many ways.
std::size_t few_frames(const SphereExperimentOptions& options) {
    return std::min(options.frames, options.quick ? 1 : most_peeled_frames);
}

std::size_t frames_of(const SphereSet& set, const SphereExperimentOptions& options) {
    constexpr std::size_t large = 20'000'000;  // C4
    return set.size() < large ? options.frames : std::min(options.frames, most_peeled_frames);
}

bool wants(const SphereExperimentOptions& options, std::string_view part) {
    return options.parts.empty() || std::ranges::find(options.parts, part) != options.parts.end();
}

void measure_opaque(const SphereSet& set, const SphereCaster& rays, const SphereExperimentOptions& options,
                    Report& report) {
    SphereStage stage(set);
    for (const SphereOrbit& orbit : sphere_orbits()) {
        const auto add_rows = [&](const SpherePart& part, std::size_t frames) {
            if (!wants(options, part.name)) return;
            const std::vector<ReferenceView> views = views_of(set, orbit, frames, options.side_px);
            for (SphereStudyRow& row : time_over_views(part, views, options.repeats)) {
                row.set = set.name;
                row.spheres = set.size();
                row.orbit = orbit.name;
                report.sphere_study.rows.push_back(std::move(row));
            }
        };
        add_rows(visibility_part(stage), frames_of(set, options));
        add_rows(light_part(stage), frames_of(set, options));
        add_rows(occlusion_part(stage, options.quick), few_frames(options));
        stage.forget_maps();
        if (options.advance) options.advance();
        if (!wants(options, "rays")) continue;
        const std::vector<ReferenceView> compared = views_of(set, orbit, options.quick ? 1 : 3, options.side_px);
        const auto drawn = [&](const ReferenceView& view) {
            stage.set_edge_places(checked_edge_places);
            stage.draw(view, {});
            stage.set_edge_places(0);
            return stage.picture();
        };
        const auto light = [&](const SpherePoint& point) { return stage.light_of(point); };
        SphereCheckRow check = check_against_rays(rays, compared, drawn, light, {.stride_px = options.quick ? 16 : 8});
        check.set = set.name;
        check.orbit = orbit.name;
        report.sphere_study.checks.push_back(std::move(check));
    }
    const auto trial_view = [&](const SphereOrbit& orbit) {
        return SphereTrialView{.view = views_of(set, orbit, 1, options.side_px).front(),
                               .timing = {.repeats = options.repeats},
                               .quick = options.quick};
    };
    const auto add_effect = [&](const char* part, auto measure, const SphereOrbit& orbit) {
        if (!wants(options, part)) return;
        EffectReport effect = measure(stage, rays, trial_view(orbit));
        effect.name = std::string(part) + " of " + set.name;
        report.effects.push_back(std::move(effect));
    };
    const SphereOrbit &whole = sphere_orbits().front(), &near = sphere_orbits().back();
    add_effect("edges", measure_sphere_edges, near);
    add_effect("detail", measure_sphere_detail, whole);
    add_effect("occlusion", measure_sphere_occlusion, whole);
    add_effect("halos", measure_sphere_halos, near);
}

/// What is only timed needs none.
bool needs_rays(const SphereExperimentOptions& options) {
    return std::ranges::any_of(sphere_experiment_parts, [&](const char* part) {
        const std::string_view name = part;
        return name != "visibility" && name != "light" && name != "maps" && wants(options, name);
    });
}

/// The same spheres, all of the study's opacity.
void measure_layers(const SphereSet& set, const SphereCaster& rays, const SphereExperimentOptions& options,
                    Report& report) {
    SphereStage stage(set);
    const SphereOrbit& orbit = sphere_orbits().front();
    const std::vector<ReferenceView> views = views_of(set, orbit, few_frames(options), options.side_px);
    LayerStudy study = measure_layers(stage, rays, views, options.repeats, options.quick);
    for (SphereStudyRow& row : study.rows) {
        row.set = set.name;
        row.spheres = set.size();
        row.orbit = orbit.name;
        report.sphere_study.rows.push_back(std::move(row));
    }
    study.effect.name = "transparency of " + set.name;
    report.effects.push_back(std::move(study.effect));
    if (options.advance) options.advance();
}

}  // namespace

std::size_t sphere_experiment_steps(std::size_t sets) {
    return sets * (sphere_orbits().size() + 1);
}

void measure_spheres(const std::vector<std::string>& names, const SphereExperimentOptions& options, Warnings& warnings,
                     Report& report) {
    for (const std::string& name : names) {
        SphereSet set = set_named(name, warnings);
        set.name = std::filesystem::path(name).stem().string();
        SphereCaster rays;
        if (needs_rays(options)) rays.add_set(set);
        measure_opaque(set, rays, options, report);
        if (wants(options, "transparency")) {
            set.opacity = static_cast<float>(studied_opacity());
            set.opacities.clear();
            measure_layers(set, rays, options, report);
        }
        report.scene += (report.scene.empty() ? "" : ", ") + set.name;
    }
    report.width = report.height = options.side_px;
}

}  // namespace matchlight
