// The table of experiments, in the order of the report.
#include "report/experiments.h"

namespace matchlight {

const std::vector<NamedExperiment>& all_experiments() {
    static const std::vector<NamedExperiment> experiments = {{"antialiasing", antialiasing_experiment},
                                                             {"contact_shadow", contact_shadow_experiment},
                                                             {"object_shadow", object_shadow_experiment},
                                                             {"reflection", reflection_experiment},
                                                             {"glossy_reflection", glossy_experiment},
                                                             {"near_reflection", near_reflection_experiment},
                                                             {"bounce_light", bounce_light_experiment},
                                                             {"mirrored_lamp", mirrored_lamp_experiment},
                                                             {"table_reflection", table_reflection_experiment},
                                                             {"lamp_on_table", lamp_on_table_experiment},
                                                             {"holdout_shadow", holdout_shadow_experiment},
                                                             {"relief", relief_experiment},
                                                             {"pattern", pattern_experiment},
                                                             {"lamp_shadow", lamp_shadow_experiment},
                                                             {"classic_shading", classic_shading_experiment},
                                                             {"depth_cue", depth_cue_experiment},
                                                             {"bloom", bloom_experiment},
                                                             {"classic_bloom", classic_bloom_experiment},
                                                             {"streaks", streaks_experiment},
                                                             {"classic_streaks", classic_streaks_experiment},
                                                             {"diffraction", diffraction_experiment},
                                                             {"motion_blur", motion_blur_experiment},
                                                             {"depth_of_field", depth_of_field_experiment},
                                                             {"surface_defocus", surface_defocus_experiment},
                                                             {"grain", grain_experiment},
                                                             {"chromatic_aberration", chromatic_aberration_experiment},
                                                             {"softness", softness_experiment},
                                                             {"color_transform", color_transform_experiment},
                                                             {"repeated_blur", repeated_blur_experiment}};
    return experiments;
}

}  // namespace matchlight
