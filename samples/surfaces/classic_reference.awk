# A ball under one parallel light by the equations of classic shading, in double precision, 64 rays a pixel: a PPM.
#
# Usage: awk -v shading=phong|blinn_phong|cartoon|gooch|cue -f classic_reference.awk > out.ppm
# The scene of gallery.sh: a ball of diameter 1 at the origin, the eye on −y, one directional light, a background.
function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] }
function normalize(a,   length_) { length_ = sqrt(dot(a, a)); a[0] /= length_; a[1] /= length_; a[2] /= length_ }
function code(light) {
    if (light > 1) light = 1
    return int(255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * light ^ (1 / 2.4) - 0.055) + 0.5)
}
# Adds to sum[] what a ray from the eye brings.
function add_ray(x, y,   d, b, c, root, t, n, h, k, i, cosine, glint, share, warmth, way, radiance) {
    d[0] = x; d[1] = 1; d[2] = -y
    k = 1 / sqrt(dot(d, d)); d[0] *= k; d[1] *= k; d[2] *= k
    b = dot(eye, d); c = dot(eye, eye) - 0.25; root = b * b - c
    if (root < 0) { for (i = 0; i < 3; ++i) sum[i] += background[i]; return }
    t = -b - sqrt(root)
    for (i = 0; i < 3; ++i) n[i] = 2 * (eye[i] + t * d[i])
    cosine = dot(n, light)
    if (shading == "blinn_phong") {
        for (i = 0; i < 3; ++i) h[i] = light[i] - d[i]
        normalize(h)
        glint = dot(n, h)
    } else {
        for (i = 0; i < 3; ++i) h[i] = 2 * cosine * n[i] - light[i]
        glint = -dot(h, d)
    }
    glint = cosine > 0 && glint > 0 ? glint ^ shininess : 0
    if (shading == "cartoon" || shading == "gooch") glint = glint >= 0.5
    share = cosine > 0 ? cosine : 0
    if (shading == "cartoon" && cosine > 0) {
        share = int(cosine * tones); if (share > tones - 1) share = tones - 1
        share /= tones - 1
    }
    warmth = 0.5 + 0.5 * cosine
    way = (t * d[1] - 1.6) / 0.3; if (way < 0) way = 0; if (way > 1) way = 1
    for (i = 0; i < 3; ++i) {
        radiance = diffuse[i] * share
        if (shading == "gooch") radiance = (1 - warmth) * (cool[i] + 0.2 * diffuse[i]) + warmth * (warm[i] + 0.6 * diffuse[i])
        radiance = irradiance / pi * (radiance + specular[i] * glint)
        sum[i] += shading == "cue" ? radiance + way * (background[i] - radiance) : radiance
    }
}
BEGIN {
    pi = atan2(0, -1); width = 480; height = 360; shininess = 40; tones = 4; irradiance = 3
    split("0.2 0.2 0.2", words); for (i = 0; i < 3; ++i) background[i] = words[i + 1]
    split("0.7 0.25 0.15", words); for (i = 0; i < 3; ++i) diffuse[i] = words[i + 1]
    split("0.6 0.6 0.6", words); for (i = 0; i < 3; ++i) specular[i] = words[i + 1]
    split("0 0 0.4", words); for (i = 0; i < 3; ++i) cool[i] = words[i + 1]
    split("0.4 0.4 0", words); for (i = 0; i < 3; ++i) warm[i] = words[i + 1]
    split("-0.5 -0.7 0.6", words); for (i = 0; i < 3; ++i) light[i] = words[i + 1]
    normalize(light)
    eye[0] = 0; eye[1] = -2.2; eye[2] = 0
    tangent = sin(pi / 12) / cos(pi / 12)  # of half the field of 30°
    printf "P3\n%d %d\n255\n", width, height
    for (y = 0; y < height; ++y)
        for (x = 0; x < width; ++x) {
            sum[0] = sum[1] = sum[2] = 0
            for (k = 0; k < 64; ++k)
                add_ray((x + (k % 8 + 0.5) / 8 - width / 2) * tangent * 2 / height, (y + (int(k / 8) + 0.5) / 8 - height / 2) * tangent * 2 / height)
            printf "%d %d %d\n", code(sum[0] / 64), code(sum[1] / 64), code(sum[2] / 64)
        }
}
