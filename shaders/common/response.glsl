// The camera's response from its table: linear light at evenly spaced codes, one row a channel.

uniform sampler2D response_linear;   // R32F, width = samples, height = 3

float response_entry(int index, int channel) { return texelFetch(response_linear, ivec2(index, channel), 0).r; }

float linear_from_code(float code, int channel) {
    int last = textureSize(response_linear, 0).x - 1;
    float at = clamp(code, 0.0, 1.0) * float(last);
    int index = min(int(at), last - 1);
    return mix(response_entry(index, channel), response_entry(index + 1, channel), at - float(index));
}

// The table increases strictly, so bisection finds the one interval that holds the value. Light beyond the last entry
// saturates the camera.
float code_from_linear(float linear, int channel) {
    int low = 0;
    int high = textureSize(response_linear, 0).x - 1;
    if (linear >= response_entry(high, channel)) return 1.0;
    if (!(linear > response_entry(0, channel))) return 0.0;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (response_entry(middle, channel) <= linear) low = middle; else high = middle;
    }
    float below = response_entry(low, channel);
    float above = response_entry(high, channel);
    return (float(low) + (linear - below) / (above - below)) / float(textureSize(response_linear, 0).x - 1);
}

vec3 linear_from_code(vec3 code) {
    return vec3(linear_from_code(code.r, 0), linear_from_code(code.g, 1), linear_from_code(code.b, 2));
}

vec3 code_from_linear(vec3 linear) {
    return vec3(code_from_linear(linear.r, 0), code_from_linear(linear.g, 1), code_from_linear(linear.b, 2));
}
