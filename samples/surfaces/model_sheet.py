#!/usr/bin/env python3
"""Renders each glTF model of a folder, with its name, onto one page."""
import argparse
import html
import json
import math
import pathlib
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def document_of(path):
    """The JSON of a .gltf or .glb file."""
    data = path.read_bytes()
    if data[:4] != b"glTF":
        return json.loads(data)
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20:20 + length])


def product(a, b):
    """Of two 4x4 matrices, column by column as glTF has them."""
    return [sum(a[k * 4 + row] * b[column * 4 + k] for k in range(4)) for column in range(4) for row in range(4)]


def matrix_of(node):
    if "matrix" in node:
        return node["matrix"]
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    sx, sy, sz = node.get("scale", [1, 1, 1])
    tx, ty, tz = node.get("translation", [0, 0, 0])
    return [(1 - 2 * (y * y + z * z)) * sx, 2 * (x * y + z * w) * sx, 2 * (x * z - y * w) * sx, 0,
            2 * (x * y - z * w) * sy, (1 - 2 * (x * x + z * z)) * sy, 2 * (y * z + x * w) * sy, 0,
            2 * (x * z + y * w) * sz, 2 * (y * z - x * w) * sz, (1 - 2 * (x * x + y * y)) * sz, 0, tx, ty, tz, 1]


def bounds_of(document):
    """Least and greatest corner, y up, of what the scene shows at rest."""
    corners = []

    def visit(index, parent):
        node = document["nodes"][index]
        world = product(parent, matrix_of(node))
        for primitive in document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            box = document["accessors"][primitive["attributes"]["POSITION"]]
            for i in range(8):
                p = [box["max" if i >> axis & 1 else "min"][axis] for axis in range(3)]
                corners.append([sum(world[k * 4 + row] * p[k] for k in range(3)) + world[12 + row] for row in range(3)])
        for child in node.get("children", []):
            visit(child, world)

    identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    scenes = document.get("scenes") or [{"nodes": list(range(len(document["nodes"])))}]
    for root in scenes[document.get("scene", 0)]["nodes"]:
        visit(root, identity)
    return [min(c[i] for c in corners) for i in range(3)], [max(c[i] for c in corners) for i in range(3)]


def scene_of(model, document):
    """The model from before it and a little above, as large as the picture."""
    least, most = bounds_of(document)
    x, y, z = ((a + b) / 2 for a, b in zip(least, most))
    radius = math.dist(least, most) / 2
    field_deg = 30
    distance = radius / math.sin(math.radians(field_deg / 2))
    return f"""[camera]
width = 640
height = 640
frames = 1
vertical_fov_deg = {field_deg}
exposure_ev = -1.5
orbit = {{target = [{x}, {-z}, {y}], radius = {distance}, elevation_deg = 12, from_deg = -80}}
[light]
probe = "{ROOT}/samples/study/studio.exr"
[background]
probe = true
[[object]]
model = {json.dumps(str(model))}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("models", type=pathlib.Path, help="folder of .glb and .gltf files")
    parser.add_argument("out", type=pathlib.Path, nargs="?", default=ROOT / "out/models", help="folder of the page")
    parser.add_argument("matchlight", nargs="?", default=str(ROOT / "build/release/matchlight"), help="the program")
    given = parser.parse_args()
    models, out, matchlight = given.models.resolve(), given.out.resolve(), given.matchlight
    out.mkdir(parents=True, exist_ok=True)
    cells = []
    all_rendered = True
    for model in sorted(models.rglob("*.gl*")):
        if model.suffix not in (".glb", ".gltf"):
            continue
        name = model.stem
        scene = out / f"{name}.toml"
        document = document_of(model)
        scene.write_text(scene_of(model, document))
        call = [matchlight, "render", str(scene), "-o", str(out / f"{name}.png"), "--level", "preview", "--overwrite"]
        result = subprocess.run(call, capture_output=True, text=True)
        told = [line for line in result.stderr.splitlines() if line.startswith(("error:", "warning:"))]
        if result.returncode != 0:
            all_rendered = False
            told = told or [f"error: status {result.returncode}"]
        print(f"{name}: {'; '.join(told) or 'rendered'}", flush=True)
        uses = ", ".join(document.get("extensionsUsed", []))
        cells.append(f'<figure><img src="{html.escape(name)}.png"><figcaption><b>{html.escape(name)}</b><br>'
                     f'{html.escape(uses)}<br>{html.escape("; ".join(told))}</figcaption></figure>')
    style = "body{font:14px sans-serif;display:flex;flex-wrap:wrap}figure{width:330px;margin:8px}img{width:100%}"
    page = out / "index.html"
    page.write_text(f'<!DOCTYPE html><meta charset="utf-8"><title>Models</title><style>{style}</style>' + "".join(cells))
    print(f"The page is {page}")
    return 0 if all_rendered else 1


sys.exit(main())
