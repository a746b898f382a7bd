// Classic shading in place of a physical material: of the lamps of the scene or, where it has none, of the bright parts of
// its probe, and of the rest of the probe's light as ambient. Include surface/lamp_light.glsl before.
// Phong 1975, "Illumination for Computer Generated Pictures"; Blinn 1977, "Models of Light Reflection for Computer Synthesized
// Pictures"; Lake, Marshall, Harris & Blackstein 2000, "Stylized Rendering Techniques for Scalable Real-Time 3D Animation"
// (cartoon); Gooch, Gooch, Shirley & Cohen 1998, "A Non-Photorealistic Lighting Model for Automatic Technical Illustration".
const int phong = 1, blinn_phong = 2, cartoon = 3, gooch = 4;  // ShadingModel (scene/classic_shading.h)
uniform int shading_model = 0;     // 0: physical
uniform float shininess;
uniform int tones;
uniform vec3 cool_color, warm_color;
uniform vec2 cool_warm_share;      // of the object's own colour in them

// What order 2 of spherical harmonics makes of a lamp's cosine: what the probe's irradiance holds of it.
float smooth_cosine(float cosine) { return 0.25 + 0.5 * cosine + 0.15625 * (3.0 * cosine * cosine - 1.0); }

// Light over π of a white surface, like all of these: lamps and ambient are of one unit.
vec3 ambient_light(vec3 n, vec3 world_position) {
    vec3 light = diffuse_radiance(n);
    for (int i = 0; i < lamp_count; ++i) {
        if (!lamp_has(lamps[i], lamp_of_probe)) continue;
        LampLight of_lamp = lamp_light(lamps[i], world_position);
        light -= of_lamp.irradiance * smooth_cosine(dot(n, of_lamp.to_lamp)) / pi;
    }
    return max(light, vec3(0.0));
}

// The highlight, 1 at its middle; not scaled with its width, as in the papers.
float highlight(vec3 n, vec3 v, vec3 l) {
    float cosine = shading_model == blinn_phong ? dot(n, normalize(v + l)) : dot(reflect(-l, n), v);
    return dot(n, l) > 0.0 ? pow(max(cosine, 0.0), shininess) : 0.0;
}

// Of a share of the light from 0 to 1: one tone is all of it, two are light and dark.
float tone_of(float share) {
    return tones < 2 ? 1.0 : floor(min(share * float(tones), float(tones - 1))) / float(tones - 1);
}

struct ClassicSurface {
    vec3 n, v;
    vec3 diffuse, specular;   // Od, Ks
    vec3 visibility;          // of the ambient light, past other objects
};

vec3 classic_radiance(ClassicSurface surface, vec3 world_position, vec3 side) {
    // Of drawings, one ambient light all over: what a ball has on the mean.
    bool is_drawn = shading_model == cartoon || shading_model == gooch;
    vec3 ambient = is_drawn ? irradiance_terms[0] / pi : ambient_light(surface.n, world_position) * surface.visibility;
    vec3 lit = vec3(0.0), glints = vec3(0.0), all = vec3(0.0);
    float towards = 0.0, weights = 0.0;
    for (int i = 0; i < lamp_count; ++i) {
        LampLight light = lamp_light(lamps[i], world_position);
        vec3 white = light.irradiance / pi;
        if (is_drawn && lamp_has(lamps[i], lamp_of_probe)) ambient -= 0.25 * white;
        all += white;
        float weight = dot(white, vec3(1.0));
        float cosine = dot(surface.n, light.to_lamp);
        towards += weight * cosine;
        weights += weight;
        if (shading_model != gooch && (cosine <= 0.0 || weight == 0.0)) continue;
        float left = shading_model == gooch ? 1.0 : lamp_share_left(lamps[i], light, world_position, unmapped_normal, side);
        float glint = highlight(surface.n, surface.v, light.to_lamp);
        if (is_drawn) glint = step(0.5, glint);
        lit += white * (shading_model == cartoon ? tone_of(left * cosine) : left * max(cosine, 0.0));
        glints += white * left * glint;
    }
    ambient = max(ambient, vec3(0.0));
    if (shading_model != gooch) return surface.diffuse * (ambient + lit) + surface.specular * glints;
    // By several lamps as by one among them; without any, light comes from above.
    float warmth = 0.5 + 0.5 * (weights > 0.0 ? towards / weights : surface.n.z);
    vec3 cool = cool_color + cool_warm_share.x * surface.diffuse;
    vec3 warm = warm_color + cool_warm_share.y * surface.diffuse;
    return mix(cool, warm, warmth) * (ambient + all) + surface.specular * glints;
}
