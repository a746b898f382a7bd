// Rows along a slanted line: texel (u, v) of a shifted texture lies at (u, v + shift(u)), so that the line through it
// passes exactly through texels of all other columns. MAJOR and MINOR are the axes' letters.
#ifndef MAJOR
#define MAJOR x
#define MINOR y
#endif

uniform float slope;

int whole_shift(int u) {
    precise float place = float(u) * slope;
    return int(floor(place + 0.5));
}
float shift(int u) {
    precise float place = float(u) * slope;
    return place - floor(place + 0.5);
}

// The texel `steps` along the line, backwards where it is negative.
ivec2 along(ivec2 texel, int steps) {
    ivec2 place = texel;
    place.MAJOR += steps;
#ifdef WHOLE
    place.MINOR += WHOLE * steps;
#else
    place.MINOR += whole_shift(place.MAJOR) - whole_shift(texel.MAJOR);
#endif
    return place;
}
