// How a lens focuses what a fragment shows: of a surface its own circle of confusion, of a mirror that of its virtual
// image.
//
// The light of a pixel comes through all points of the lens. Seen from another point, u lens diameters beside the
// middle, the pixel shows the surface −coc · u pixels away, and the reflected direction turns for two reasons: with the
// place, by −coc · J u (J: its change from plate pixel to plate pixel), and with the eye, by K u. A blur of the picture
// over a circle c turns it by −c · J u; the circle that does what the lens does, as nearly as one number can, is the
// least-squares solution of −c J = −coc J + K. For a sphere met head on that is the circle of the depth of its virtual
// image, half a radius behind the surface; towards a silhouette, where J grows, it becomes the surface's own.

uniform float coc_scale_px_m = 1.0;
uniform float focus_per_m = 1.0;         // 1 / focus distance
uniform float near_m = 0.01;
uniform bool object_is_sharp = false;    // whatever its depth
uniform float object_focus_per_m = 1.0;  // of what is drawn next, which may have a focus of its own
uniform vec3 lens_right_world_m;         // the lens' diameter along the picture's x and y
uniform vec3 lens_down_world_m;
uniform vec2 coc_range_px = vec2(0.0);   // the nearest and the farthest that the blur is made for
uniform float layer_density = 1.0;       // pixels along a plate pixel
uniform bool focuses_reflections = false;

// Of the reflection: the circle that its light is to be drawn with, signed; the diameter of the disc that it is to be
// spread over besides, where it is lit; and how it turns from plate pixel to plate pixel.
float reflection_coc_px = 0.0, reflection_left_px = 0.0;
vec3 reflection_dx = vec3(0.0), reflection_dy = vec3(0.0);

// Narrower discs are none, as circles of confusion are.
const float least_left_px = 0.25;

float surface_coc_px() { return object_is_sharp ? 0.0 : coc_scale_px_m * (object_focus_per_m - inverse_z()); }

// The turn when the eye moves by `way_m`: of v, as the eye sees the place, and with it of 2 (n·v) n − v.
vec3 turn_with_eye(vec3 way_m, vec3 n, vec3 v, float distance_m) {
    vec3 turn = (way_m - dot(way_m, v) * v) / distance_m;
    return 2.0 * dot(n, turn) * n - turn;
}

// Sets what is known of the reflection, whose direction changes by `dx` and `dy` from fragment to fragment.
void focus_reflection(vec3 n, vec3 v, float distance_m, vec3 dx, vec3 dy) {
    float coc_px = surface_coc_px();
    reflection_coc_px = coc_px;
    reflection_dx = layer_density * dx;
    reflection_dy = layer_density * dy;
    if (object_is_sharp || !focuses_reflections) return;
    vec3 kx = turn_with_eye(lens_right_world_m, n, v, distance_m);
    vec3 ky = turn_with_eye(lens_down_world_m, n, v, distance_m);
    float turn2 = max(dot(reflection_dx, reflection_dx) + dot(reflection_dy, reflection_dy), 1e-20);
    float image_px = abs(coc_px - (dot(kx, reflection_dx) + dot(ky, reflection_dy)) / turn2);
    float drawn_px = image_px;
    // A circle wider than the surface's would leave the surface's edges. Where a curved mirror ends it comes to the
    // surface's by itself; on a flat one, whose reflection turns as much as the eye does, the light is spread instead.
    if (image_px > abs(coc_px)) {
        float eye2 = (dot(kx, kx) + dot(ky, ky)) * pow(inverse_z() * coc_scale_px_m, -2.0);
        drawn_px = mix(image_px, abs(coc_px), min(eye2 / turn2, 1.0));
    }
    drawn_px = min(drawn_px, max(coc_px < 0.0 ? -coc_range_px.x : coc_range_px.y, abs(coc_px)));
    // Whichever side of the focus the image lies on, it is seen where the surface is.
    reflection_coc_px = coc_px < 0.0 ? -drawn_px : drawn_px;
    reflection_left_px = sqrt(max(image_px * image_px - drawn_px * drawn_px, 0.0));
}

// Whether a lobe of this deviation blurs the reflection so far that the disc that is left would widen it by half a percent
// at most: a hundredth of its variance.
bool is_blurred_by(float lobe) {
    float turn2 = 0.5 * (dot(reflection_dx, reflection_dx) + dot(reflection_dy, reflection_dy));
    return turn2 * reflection_left_px * reflection_left_px / 16.0 < 0.01 * lobe * lobe;
}

// The turn of the reflection through one of `count` points spread evenly over the disc that is left: a sunflower's.
vec3 turn_through_lens(int i, int count) {
    vec2 at = 0.5 * reflection_left_px * disc_point(i, count, 0.0);
    return at.x * reflection_dx + at.y * reflection_dy;
}

// The circle of all that is seen, of which the reflection is a share. What a lobe of the deviation `lobe` has blurred
// looks the same through either circle; it takes the surface's, which keeps the edges.
float seen_coc_px(float share, float lobe) {
    float coc_px = surface_coc_px();
    float turn2 = 0.5 * (dot(reflection_dx, reflection_dx) + dot(reflection_dy, reflection_dy));
    float widest_px = max(abs(coc_px), abs(reflection_coc_px));
    float of_lens = turn2 * widest_px * widest_px / 16.0;  // variance over a disc
    float clear = of_lens / max(of_lens + lobe * lobe, 1e-30);
    return mix(coc_px, reflection_coc_px, clamp(share, 0.0, 1.0) * clear);
}

// near_m / z of a point without a focus of its own that has this circle; never 0, which means nothing.
float focus_share_of(float coc_px) {
    float share = near_m * (focus_per_m - coc_px / coc_scale_px_m);
    return share == 0.0 ? 1e-30 : share;
}
