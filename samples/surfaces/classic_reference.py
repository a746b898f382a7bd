#!/usr/bin/env python3
"""A ball under one parallel light, drawn by the equations of classic shading and of colours in double precision.

It is the ball of gallery.sh: of diameter 1 at the origin, the eye at (0, -2.2, 0), the light from (-0.5, -0.7, 0.6).
Phong 1975; Blinn 1977; Lake et al. 2000 (cartoon); Gooch et al. 1998; Smith 1978 (HSV); NTSC 1953 (YIQ). Only what comes
with Python is used.
"""
import argparse
import colorsys
import math
import pathlib
import struct
import zlib

WIDTH, HEIGHT, RAYS_A_SIDE = 240, 180, 4
EYE = (0.0, -2.2, 0.0)
BACKGROUND = (0.2, 0.2, 0.2)
DIFFUSE, SPECULAR, SHININESS, TONES = (0.7, 0.25, 0.15), (0.6, 0.6, 0.6), 40, 4
COOL, WARM, COOL_SHARE, WARM_SHARE = (0, 0, 0.4), (0.4, 0.4, 0), 0.2, 0.6
IRRADIANCE = 3
CUE_NEAR_M, CUE_FAR_M = 1.6, 1.9


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


LIGHT = unit((-0.5, -0.7, 0.6))


def radiance(shading, n, d, z_m):
    """What the ball sends against the ray d from a point of normal n, z_m along the camera's axis."""
    cosine = dot(n, LIGHT)
    if shading == "blinn_phong":
        glint = dot(n, unit(tuple(l - x for l, x in zip(LIGHT, d))))
    else:
        glint = -dot(tuple(2 * cosine * x - l for x, l in zip(n, LIGHT)), d)
    glint = glint ** SHININESS if cosine > 0 and glint > 0 else 0.0
    share = max(cosine, 0.0)
    if shading in ("cartoon", "gooch"):
        glint = 1.0 if glint >= 0.5 else 0.0
    if shading == "cartoon" and cosine > 0:
        share = min(math.floor(cosine * TONES), TONES - 1) / (TONES - 1)
    base = [x * share for x in DIFFUSE]
    if shading == "gooch":
        warmth = 0.5 + 0.5 * cosine
        base = [(1 - warmth) * (c + COOL_SHARE * x) + warmth * (w + WARM_SHARE * x)
                for c, w, x in zip(COOL, WARM, DIFFUSE)]
    light = [IRRADIANCE / math.pi * (b + s * glint) for b, s in zip(base, SPECULAR)]
    if shading == "depth_cue":
        way = min(max((z_m - CUE_NEAR_M) / (CUE_FAR_M - CUE_NEAR_M), 0.0), 1.0)
        light = [x + way * (b - x) for x, b in zip(light, BACKGROUND)]
    return light


def ray(shading, x, y):
    """Light along the ray through a point of the picture, and whether it is the ball's."""
    tangent = 2 * math.tan(math.radians(15)) / HEIGHT
    d = unit(((x - WIDTH / 2) * tangent, 1.0, -(y - HEIGHT / 2) * tangent))
    along = dot(EYE, d)
    root = along * along - dot(EYE, EYE) + 0.25
    if root < 0:
        return None
    t = -along - math.sqrt(root)
    return radiance(shading, tuple(2 * (e + t * q) for e, q in zip(EYE, d)), d, t * d[1])


def code_of(light):
    return 12.92 * light if light <= 0.0031308 else 1.055 * light ** (1 / 2.4) - 0.055


def light_of(code):
    return code / 12.92 if code <= 0.04045 else ((code + 0.055) / 1.055) ** 2.4


YIQ = ((0.299, 0.587, 0.114), (0.595716, -0.274453, -0.321263), (0.211456, -0.522591, 0.311135))


def rgb_from_yiq(yiq):
    """Cramer's rule."""
    def determinant(m):
        return (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]))
    whole = determinant(YIQ)
    return [determinant([[yiq[i] if k == column else YIQ[i][k] for k in range(3)] for i in range(3)]) / whole
            for column in range(3)]


def turned_in_hsv(code):
    h, s, v = colorsys.rgb_to_hsv(*code)
    return colorsys.hsv_to_rgb((h + 1 / 3) % 1, s, v)


def turned_in_yiq(code):
    y, i, q = (dot(row, code) for row in YIQ)
    c, s = math.cos(math.radians(120)), math.sin(math.radians(120))
    return rgb_from_yiq([y, c * i - s * q, s * i + c * q])


TRANSFORMS = {
    "brightness": lambda code: [x + 0.15 for x in code],
    "contrast": lambda code: [(x - 0.5) * 1.6 + 0.5 for x in code],
    "fade": lambda code: [x + 0.5 * (f - x) for x, f in zip(code, (0.8, 0.85, 0.9))],
    "grey_hsv": lambda code: [max(code)] * 3,
    "grey_average": lambda code: [sum(code) / 3] * 3,
    "grey_yiq": lambda code: [dot(YIQ[0], code)] * 3,
    "tinted_grey": lambda code: [t * dot(YIQ[0], code) for t in (1, 0.82, 0.6)],
    "hue_hsv": turned_in_hsv,
    "hue_yiq": turned_in_yiq,
    "matrix": lambda code: [code[2], code[1], code[0]],
}


def pixel(shading, transform, x, y):
    """RGB codes: the ball's mean light, transformed, over the background by how much of the pixel it covers."""
    rays = [ray(shading, x + (i + 0.5) / RAYS_A_SIDE, y + (k + 0.5) / RAYS_A_SIDE)
            for i in range(RAYS_A_SIDE) for k in range(RAYS_A_SIDE)]
    met = [light for light in rays if light is not None]
    covered = len(met) / len(rays)
    light = list(BACKGROUND)
    if met:
        own = [sum(channel) / len(met) for channel in zip(*met)]
        if transform:
            own = [light_of(max(c, 0.0)) for c in TRANSFORMS[transform]([code_of(c) for c in own])]
        light = [covered * o + (1 - covered) * b for o, b in zip(own, BACKGROUND)]
    return bytes(round(255 * code_of(min(c, 1.0))) for c in light)


def save_png(path, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)
    pixels = zlib.compress(b"".join(b"\0" + row for row in rows))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b""))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["phong", "blinn_phong", "cartoon", "gooch", "depth_cue", *TRANSFORMS])
    parser.add_argument("png", type=pathlib.Path)
    given = parser.parse_args()
    transform = given.what if given.what in TRANSFORMS else None
    shading = "phong" if transform else given.what
    save_png(given.png, [b"".join(pixel(shading, transform, x, y) for x in range(WIDTH)) for y in range(HEIGHT)])


main()
