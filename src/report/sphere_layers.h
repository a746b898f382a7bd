// Spheres that let light through, peeled as far as a tolerance asks: what it costs, and what it leaves out.
#pragma once

#include <span>
#include <vector>

#include "report/report.h"
#include "report/sphere_stage.h"
#include "scene/sphere_caster.h"

namespace matchlight {

/// For which 32 layers keep to a tolerance of 8 where codes are linear in light.
double studied_opacity();

struct LayerStudy {
    std::vector<SphereStudyRow> rows;  // parts "layers" and "peeling"; lack only what they are of
    EffectReport effect;               // the ways of "peeling" against the exact composite; lacks its name
};

/// `stage` has one set that lets light through; `rays` the same. At least one view.
LayerStudy measure_layers(SphereStage& stage, const SphereCaster& rays, std::span<const ReferenceView> views,
                          int repeats, bool quick);

}  // namespace matchlight
