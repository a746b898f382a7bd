// The ray of a pixel, in the axes of a set of spheres, and where it meets one.
uniform mat3 ray_from_ndc;  // × (ndc, 1): the direction, one metre along the picture's z; PARALLEL: the vectors square to
                            // the rays that make a step of ndc, and the rays' direction, of unit length
uniform vec2 picture_px;
uniform float near_plane_m;

vec2 ndc_of(vec2 pixel) { return vec2(2.0, -2.0) * pixel / picture_px + vec2(-1.0, 1.0); }
vec2 picture_ndc() { return ndc_of(gl_FragCoord.xy); }
vec3 ray_direction(vec2 ndc) { return ray_from_ndc * vec3(ndc, 1.0); }

// The nearest place at or beyond the near plane, in multiples of the direction, −1: none. `a` is the square of the
// direction, `b` its product with the eye less the centre, `root` that of what is left of the radius' square.
float nearest_by_root(float a, float b, float power, float root) {
    float nearer, farther;
    if (b < 0.0) {
        nearer = power / (root - b);
        farther = (root - b) / a;
    } else {
        nearer = -(root + b) / a;
        farther = -power / (root + b);
    }
    float met = nearer >= near_plane_m ? nearer : farther;
    return met >= near_plane_m ? met : -1.0;
}

// The same of a sphere, `power` that of the eye in it. (Haines, Günther & Akenine-Möller 2019, "Precision Improvements for
// Ray/Sphere Intersection", Ray Tracing Gems, ch. 7: from the foot of the centre on the ray, and the nearer root by the
// product of both.)
float nearest_on_sphere(vec4 from_centre_radius, float power, vec3 direction) {
    vec3 from_centre = from_centre_radius.xyz;
    float radius = from_centre_radius.w;
    float a = dot(direction, direction);
    float b = dot(from_centre, direction);
    vec3 foot = from_centre - (b / a) * direction;
    float left = (radius - length(foot)) * (radius + length(foot));
    return left >= 0.0 ? nearest_by_root(a, b, power, sqrt(a * left)) : -1.0;
}

uniform bool some_stand_for_others;  // and are drawn larger than they are (render/sphere_culling.h: SphereDetail)

// The radius that a sphere was drawn with, which only the place tells where its ray met it; by less it is rounding.
float drawn_radius(vec4 from_centre_radius, vec3 met) {
    const float enlarged = 1.1;
    float radius = length(from_centre_radius.xyz + met);
    return some_stand_for_others && radius > enlarged * from_centre_radius.w ? radius : from_centre_radius.w;
}
