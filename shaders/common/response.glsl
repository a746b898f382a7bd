// The camera's response from its table: linear light at evenly spaced codes, one row a channel.

uniform sampler2D response_linear;   // rows 0 to 2: light at each code, R, G, B; rows 3 to 5: see below

float response_entry(int index, int channel) { return texelFetch(response_linear, ivec2(index, channel), 0).r; }

float linear_from_code(float code, int channel) {
    int last = textureSize(response_linear, 0).x - 1;
    float at = clamp(code, 0.0, 1.0) * float(last);
    int index = min(int(at), last - 1);
    return mix(response_entry(index, channel), response_entry(index + 1, channel), at - float(index));
}

// The table increases strictly, so one interval holds the value: rows 3 to 5 say where to start looking, at evenly spaced
// roots of light, and a few steps find it. Light beyond the last entry saturates the camera.
float code_from_linear(float linear, int channel) {
    int last = textureSize(response_linear, 0).x - 1;
    float white = response_entry(last, channel);
    if (linear >= white) return 1.0;
    if (!(linear > response_entry(0, channel))) return 0.0;
    int index = int(texelFetch(response_linear, ivec2(int(sqrt(linear / white) * float(last)), channel + 3), 0).r);
    float below = response_entry(index, channel);
    while (below > linear && index > 0) below = response_entry(--index, channel);
    float above = response_entry(index + 1, channel);
    while (above <= linear && index + 2 <= last) {
        below = above;
        ++index;
        above = response_entry(index + 1, channel);
    }
    return (float(index) + (linear - below) / (above - below)) / float(last);
}

// Light within is Rec.709's; the footage's codes are of primaries of their own (core/primaries.h).
uniform mat3 rec709_from_footage = mat3(1.0);
uniform mat3 footage_from_rec709 = mat3(1.0);

vec3 linear_from_code(vec3 code) {
    return rec709_from_footage * vec3(linear_from_code(code.r, 0), linear_from_code(code.g, 1), linear_from_code(code.b, 2));
}

vec3 code_from_linear(vec3 rec709) {
    vec3 linear = footage_from_rec709 * rec709;
    return vec3(code_from_linear(linear.r, 0), code_from_linear(linear.g, 1), code_from_linear(linear.b, 2));
}
