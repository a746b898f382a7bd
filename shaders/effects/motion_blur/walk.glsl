// Taps along a way: whole pixels along its longer axis, between two pixels across it.

uniform int most_taps;  // on either side

struct Walk {
    vec2 step_px;   // from tap to tap
    float spacing;  // its length
    int taps;       // on either side
};

Walk walk_along(vec2 way) {
    float longer = max(abs(way.x), abs(way.y));
    int pixels = int(ceil(0.5 * longer + 0.5));
    int stride = (pixels + most_taps - 1) / most_taps;
    Walk walk;
    walk.step_px = way / longer * float(stride);
    walk.spacing = length(walk.step_px);
    walk.taps = (pixels + stride - 1) / stride;
    return walk;
}

// The share of a smear of some length around a point that falls on the stretch `spacing` around a tap at distance t.
float smear_at(float t, float spacing, float smear) {
    float low = max(t - 0.5 * spacing, -0.5 * smear);
    float high = min(t + 0.5 * spacing, 0.5 * smear);
    return smear > 0.0 ? max(high - low, 0.0) / smear : (t == 0.0 ? 1.0 : 0.0);
}

// The pixel of a tap, the next one across the way, and that one's share.
struct Tap {
    ivec2 first, second;
    float second_share;
};

Tap tap_at(ivec2 pixel, Walk walk, int i) {
    vec2 offset = walk.step_px * float(i);
    bool along_x = abs(walk.step_px.x) >= abs(walk.step_px.y);
    float across = along_x ? offset.y : offset.x;
    int low = int(floor(across));
    int along = int(round(along_x ? offset.x : offset.y));
    Tap tap;
    tap.first = pixel + (along_x ? ivec2(along, low) : ivec2(low, along));
    tap.second = tap.first + (along_x ? ivec2(0, 1) : ivec2(1, 0));
    tap.second_share = across - float(low);
    return tap;
}
