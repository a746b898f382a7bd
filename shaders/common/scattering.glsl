// What of its light a metallic-roughness surface sends back, and how much of it as if diffuse.

// Light that a GGX surface reflects at its first meeting with it, and after several.
struct Scattering {
    vec3 single, multiple;
};

// Fdez-Agüera 2019, "A Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting": what the split sum
// misses comes back as if diffuse, so that a white surface in white light sends back all of it.
// Of what reflects `f0` head on and `f90` edge on.
Scattering scattering(vec3 f0, float f90, vec2 table) {
    vec3 single = f0 * table.x + f90 * table.y;
    float missing = 1.0 - (table.x + table.y);
    vec3 mean_fresnel = f0 + (f90 - f0) / 21.0;
    return Scattering(single, missing * single * mean_fresnel / (1.0 - mean_fresnel * missing));
}
Scattering scattering(vec3 f0, vec2 table) { return scattering(f0, 1.0, table); }

// glTF 2.0, appendix B.
const vec3 dielectric_f0 = vec3(0.04);

// A mixture of two materials, so that each keeps its own energy: glTF 2.0, appendix B.
struct MaterialScattering {
    vec3 mirrored;   // times what the lobe around the reflection shows
    vec3 diffuse;    // times irradiance over π
#ifdef TRANSMISSION
    vec3 entered;    // of that, what goes below the surface
#endif
};
#ifdef TRANSMISSION
#define sends(mirrored, multiple, entered) MaterialScattering(mirrored, multiple + entered, entered)
#else
#define sends(mirrored, multiple, entered) MaterialScattering(mirrored, multiple + entered)
#endif
MaterialScattering material_scattering(vec3 base, float metallic, vec2 table) {
    Scattering dielectric = scattering(dielectric_f0, table);
    Scattering metal = scattering(base, table);
    vec3 multiple = mix(dielectric.multiple, metal.multiple, metallic);
    vec3 entered = (1.0 - metallic) * base * (1.0 - dielectric.single - dielectric.multiple);
    return sends(mix(dielectric.single, metal.single, metallic), multiple, entered);
}

#ifdef SPECULAR
// The same, of a dielectric that reflects `specular` head on, and its a edge on.
MaterialScattering material_scattering(vec3 base, float metallic, vec2 table, vec4 specular) {
    Scattering dielectric = scattering(specular.rgb, specular.a, table);
    Scattering metal = scattering(base, table);
    vec3 multiple = mix(dielectric.multiple, metal.multiple, metallic);
    // The largest channel decides: a tinted reflection does not tint what is below with its complement.
    vec3 taken = dielectric.single + dielectric.multiple;
    vec3 entered = (1.0 - metallic) * base * (1.0 - max(taken.r, max(taken.g, taken.b)));
    return sends(mix(dielectric.single, metal.single, metallic), multiple, entered);
}
#endif
