// What objects change of the light that the real surface mirrors (effects/surface_reflection).

uniform sampler2D mirrored_objects;   // RGB: weighted light of objects; a: weight of all rays
uniform sampler2D mirrored_covered;   // RGB: weighted light of the probe that those objects cover
uniform sampler2D mirrored_shown;     // RGB: what is mirrored without objects; a: share of light that is mirrored

// To be added to `plate · ratio`. What the plate shows is light that it mirrors, and light that it scatters: the shadow's
// ratio is right for the second alone, so the first is put back where no object covers it. The plate cannot mirror more
// than it shows, however bright the probe is there: so the sum is never below zero.
vec3 mirrored_change(ivec2 texel, vec3 plate, vec3 ratio, vec3 plate_from_probe) {
    vec4 shown = texelFetch(mirrored_shown, texel, 0);
    if (!(shown.a > 0.0)) return vec3(0.0);
    vec4 objects = texelFetch(mirrored_objects, texel, 0);
    float a_ray = objects.a > 0.0 ? shown.a / objects.a : 0.0;
    vec3 brought = objects.rgb * a_ray * plate_from_probe;
    vec3 all = shown.rgb * plate_from_probe;
    vec3 taken = texelFetch(mirrored_covered, texel, 0).rgb * a_ray * plate_from_probe;
    vec3 known = clamp(plate / max(all, vec3(1e-20)), 0.0, 1.0);
    all *= known;
    taken = min(taken * known, all);
    return brought - taken * ratio + (all - taken) * (1.0 - ratio);
}
