// Pictures over a surface's colour, each over those before it: MT(n) = T(n)·a + MT(n−1)·(1 − a).
// PICTURE_LAYERS: how many.
uniform sampler2DArray picture_layers;                    // sRGB
uniform vec3 picture_layer_alpha_scale[PICTURE_LAYERS];  // x: alpha, y: times the coordinates

vec3 with_picture_layers(vec3 color, vec2 uv) {
    for (int i = 0; i < PICTURE_LAYERS; ++i) {
        float scale = picture_layer_alpha_scale[i].y;
#ifdef RELIEF
        vec4 picture =
            textureGrad(picture_layers, vec3(scale * uv, float(i)), scale * relief_uv_dx, scale * relief_uv_dy);
#else
        vec4 picture = texture(picture_layers, vec3(scale * uv, float(i)));
#endif
        float alpha = picture_layer_alpha_scale[i].x * picture.a;
        color = picture.rgb * alpha + color * (1.0 - alpha);
    }
    return color;
}
