#!/usr/bin/env python3
"""Times VTK's sphere mapper on a set of spheres: the peer that `matchlight report --spheres` is compared with.

Needs Debian's python3-vtk9, python3-numpy and xvfb; neither the package nor the tests do. Both programs should draw on
the same machine with nothing else to do, in turn:

    matchlight spheres generate C2 -o c2.ply
    xvfb-run -a -s "-screen 0 1280x1280x24" /usr/bin/python3 tests/benchmark/peer_vtk_spheres.py c2.ply --frames 6
    matchlight report --spheres c2.ply --frames 6 -o report

Reads binary PLY (x, y, z and radius among the properties), CSV with a header that names them, or raw float32 (x, y, z,
radius a sphere). The camera is that of the report: an orbit about the middle of the set's box, looking at it from
20 degrees above with a vertical angle of 40 degrees, at a distance in half diagonals of the box. VTK draws with its
Phong light and without anti-aliasing; a frame is timed from Render() to the end of glFinish(). Prints JSON.
"""
import argparse
import json
import math
import statistics
import sys
import time

import numpy
import vtkmodules.vtkRenderingOpenGL2  # registers the OpenGL classes
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

FIELDS = ("x", "y", "z", "radius")
PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}


def read_ply(path):
    with open(path, "rb") as file:
        order, fields, count, in_vertices = "<", [], 0, False
        while True:
            words = file.readline().decode("ascii").split()
            if not words:
                sys.exit(f"{path}: the PLY header does not end")
            if words[0] == "format":
                if words[1] == "ascii":
                    sys.exit(f"{path}: is a PLY in ASCII: write it in binary")
                order = ">" if words[1] == "binary_big_endian" else "<"
            elif words[0] == "element":
                in_vertices = words[1] == "vertex"
                count = int(words[2]) if in_vertices else count
            elif words[0] == "property" and in_vertices:
                fields.append((words[2], order + PLY_TYPES[words[1]]))
            elif words[0] == "end_header":
                break
        vertices = numpy.fromfile(file, numpy.dtype(fields), count)
    return numpy.stack([vertices[name].astype(numpy.float32) for name in FIELDS], axis=1)


def read_spheres(path):
    """n rows of x, y, z, radius in float32."""
    if path.endswith(".ply"):
        return read_ply(path)
    if path.endswith(".csv"):
        with open(path, encoding="utf-8") as file:
            names = [name.strip() for name in file.readline().split(",")]
        columns = [names.index(name) for name in FIELDS]
        return numpy.loadtxt(path, numpy.float32, delimiter=",", skiprows=1, usecols=columns, ndmin=2)
    return numpy.fromfile(path, numpy.float32).reshape(-1, 4)


def poly_data_of(spheres):
    points = vtkPoints()
    points.SetData(numpy_to_vtk(numpy.ascontiguousarray(spheres[:, :3]), deep=1))
    radius = numpy_to_vtk(numpy.ascontiguousarray(spheres[:, 3]), deep=1)
    radius.SetName("radius")
    # One cell of all points: without any the mapper draws nothing.
    count = len(spheres)
    vertices = vtkCellArray()
    vertices.SetData(numpy_to_vtkIdTypeArray(numpy.array([0, count], numpy.int64), deep=1),
                     numpy_to_vtkIdTypeArray(numpy.arange(count, dtype=numpy.int64), deep=1))
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetVerts(vertices)
    data.GetPointData().AddArray(radius)
    return data


def renderer_of(spheres):
    mapper = vtkmodules.vtkRenderingOpenGL2.vtkOpenGLSphereMapper()
    mapper.SetInputData(poly_data_of(spheres))
    mapper.SetScaleArray("radius")
    mapper.SetScalarVisibility(False)
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.8, 0.8, 0.8)
    actor.GetProperty().SetSpecular(0.3)
    actor.GetProperty().SetSpecularPower(30)
    renderer = vtkRenderer()
    renderer.AddActor(actor)
    return renderer


def place_camera(renderer, spheres, turn, distance):
    low = (spheres[:, :3] - spheres[:, 3:]).min(axis=0).astype(float)
    high = (spheres[:, :3] + spheres[:, 3:]).max(axis=0).astype(float)
    middle, reach = (low + high) / 2, distance * numpy.linalg.norm(high - low) / 2
    up = math.radians(20)
    direction = numpy.array([math.cos(up) * math.cos(turn), math.cos(up) * math.sin(turn), math.sin(up)])
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*middle)
    camera.SetPosition(*(middle + reach * direction))
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(40)
    renderer.ResetCameraClippingRange()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("spheres", help="a .ply, a .csv, or raw float32")
    parser.add_argument("--frames", type=int, default=6, help="of the orbit (6)")
    parser.add_argument("--distance", type=float, default=3.0, help="of the camera, in half diagonals of the box (3)")
    parser.add_argument("--size", type=int, default=1024, help="pixels a side (1024)")
    parser.add_argument("--picture", help="a PNG of the last frame")
    arguments = parser.parse_args()

    spheres = read_spheres(arguments.spheres)
    renderer = renderer_of(spheres)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(arguments.size, arguments.size)
    window.AddRenderer(renderer)

    times_ms = []
    place_camera(renderer, spheres, 0, arguments.distance)
    window.Render()  # uploads and compiles
    window.WaitForCompletion()
    for frame in range(arguments.frames):
        place_camera(renderer, spheres, 2 * math.pi * frame / arguments.frames, arguments.distance)
        start = time.perf_counter()
        window.Render()
        window.WaitForCompletion()
        times_ms.append(1e3 * (time.perf_counter() - start))
    if arguments.picture:
        shown = vtkWindowToImageFilter()
        shown.SetInput(window)
        writer = vtkPNGWriter()
        writer.SetFileName(arguments.picture)
        writer.SetInputConnection(shown.GetOutputPort())
        writer.Write()
    driver = [line.split(":", 1)[1].strip() for line in window.ReportCapabilities().splitlines()
              if line.startswith("OpenGL renderer string")]
    print(json.dumps({"program": f"VTK {vtkVersion.GetVTKVersion()}, vtkOpenGLSphereMapper",
                      "renderer": driver[0] if driver else "", "spheres": len(spheres), "width": arguments.size,
                      "height": arguments.size, "distance": arguments.distance, "frames": arguments.frames,
                      "ms_median": statistics.median(times_ms), "ms_min": min(times_ms), "ms_max": max(times_ms),
                      "ms": times_ms}, indent=2))


if __name__ == "__main__":
    main()
