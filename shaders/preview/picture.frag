#version 450 core
// The picture in its place in the window, black around it. Code values pass as they are.
uniform sampler2D picture;
uniform vec4 place;  // left, top, width, height: pixels of the window

layout(location = 0) out vec4 shown;

void main() {
    vec2 at = (gl_FragCoord.xy - place.xy) / place.zw;
    bool inside = all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)));
    shown = vec4(inside ? texture(picture, at).rgb : vec3(0.0), 1.0);
}
