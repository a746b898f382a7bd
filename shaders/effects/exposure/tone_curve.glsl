// The photographic tone curve (Reinhard et al. 2002, equation 4) on luminance; colours keep their ratios.

// Light that is shown as white; 0: no curve. At 1 the curve is the identity.
uniform float white_light = 0.0;

vec3 toned(vec3 linear) {
    float luminance = dot(linear, vec3(0.2126, 0.7152, 0.0722));
    if (!(white_light > 0.0) || !(luminance > 0.0)) return linear;
    return linear * ((1.0 + luminance / (white_light * white_light)) / (1.0 + luminance));
}
