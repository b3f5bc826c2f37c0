"""Readers of the files that palpate writes for other programs.

They follow the formats' specifications, independently of palpate; each checks the requirements of its format.
"""
import base64
import json
import struct
import xml.etree.ElementTree as ET
from pathlib import Path

import h5py
import numpy as np


def demand(condition, what):
    if not condition:
        raise ValueError(what)


def numbers(text):
    return [int(word) for word in text.split()]


# --- XDMF ---------------------------------------------------------------------------------------------------

NUMPY = {("Float", "8"): np.float64, ("Int", "4"): np.int32}


def hdf(folder, item, address):
    """Returns the data set at FILE:PATH, after checking the type and shape that the item states."""
    name, path = address.split(":", 1)
    demand(not Path(name).is_absolute(), "the sidecar must be able to move together with its file")
    with h5py.File(folder / name, "r") as file:
        data = file[path]
        demand(data.dtype == NUMPY[item.get("NumberType"), item.get("Precision")], f"type of {path}")
        return data[()]


def data_item(folder, item):
    """Reads a DataItem by the rules of XDMF 2 and of XDMF 3: both must give the same."""
    shape = tuple(numbers(item.get("Dimensions")))
    demand(item.get("Format") == "HDF", "Format")
    demand("ItemType" not in item.attrib, "readers of XDMF 3 cannot read what they take for a hyperslab")
    text = item.text.strip()
    if item.get("Type") != "HyperSlab":
        data = hdf(folder, item, text)
        demand(data.shape == shape, f"Dimensions of {text}")
        return data

    selection, source = list(item)
    start, stride, count = np.array(numbers(selection.text)).reshape(numbers(selection.get("Dimensions")))
    whole = data_item(folder, source)
    seen_by_2 = whole[tuple(slice(a, a + s * n, s) for a, s, n in zip(start, stride, count))]
    demand(seen_by_2.shape == shape, "the hyperslab ends before its count")

    address, selection = text.split("|")
    start, stride, count, dataspace = ([int(n) for n in part.split()] for part in selection.split(":"))
    whole = hdf(folder, item, address)
    demand(list(whole.shape) == dataspace, "dataspace")
    seen_by_3 = whole[tuple(slice(a, a + s * n, s) for a, s, n in zip(start, stride, count))]
    demand(np.array_equal(seen_by_2, seen_by_3), "readers of XDMF 2 and 3 see different numbers")
    return seen_by_2


CORNERS = {"Tetrahedron": 4, "Triangle": 3}


def uniform_grid(folder, grid):
    topology, geometry = grid.find("Topology"), grid.find("Geometry")
    demand(geometry.get("GeometryType") == "XYZ", "GeometryType")
    cells = data_item(folder, topology.find("DataItem"))
    corners = CORNERS[topology.get("TopologyType")]
    demand(cells.shape == (int(topology.get("NumberOfElements")), corners), "cells")
    points = data_item(folder, geometry.find("DataItem"))
    demand(cells.min() >= 0 and cells.max() < len(points), "cells of the points")
    out = {"name": grid.get("Name"), "kind": topology.get("TopologyType"), "cells": cells, "points": points}
    for attribute in grid.findall("Attribute"):
        values = data_item(folder, attribute.find("DataItem"))
        size = len(points) if attribute.get("Center") == "Node" else len(cells)
        demand(values.shape == {"Vector": (size, 3), "Scalar": (size,)}[attribute.get("AttributeType")],
               attribute.get("Name"))
        out[attribute.get("Name")] = values
    return out


def read_xdmf(path):
    """Returns a list of {"time", "grids"}."""
    root = ET.parse(path).getroot()
    demand(root.tag == "Xdmf", "root")
    series = root.find("Domain/Grid")
    demand((series.get("GridType"), series.get("CollectionType")) == ("Collection", "Temporal"), "temporal")
    steps, texts = [], set()
    for step in series:
        demand((step.get("GridType"), step.get("CollectionType")) == ("Collection", "Spatial"), "spatial")
        grids = step.findall("Grid")
        steps.append({"time": float(step.find("Time").get("Value")),
                      "grids": [uniform_grid(Path(path).parent, grid) for grid in grids]})
        texts.update((grid.get("Name"), grid.find("Geometry/DataItem").text) for grid in grids)
    demand(len(texts) == sum(len(step["grids"]) for step in steps),
           "ParaView keeps a grid whose geometry has the text of the step before")
    return steps


# --- VTK's XML ----------------------------------------------------------------------------------------------

VTK = {"Float64": np.float64, "Int32": np.int32, "UInt8": np.uint8}


def vtk_array(element):
    demand(element.get("format") == "binary", "format")
    raw = base64.b64decode(element.text, validate=True)
    size, = struct.unpack_from("<Q", raw)
    demand(len(raw) == 8 + size, f"bytes of {element.get('Name')}")
    values = np.frombuffer(raw[8:], VTK[element.get("type")])
    width = int(element.get("NumberOfComponents"))
    return values.reshape(-1, width) if width > 1 else values


def read_vtu(path):
    root = ET.parse(path).getroot()
    demand(root.attrib == {"type": "UnstructuredGrid", "version": "1.0", "byte_order": "LittleEndian",
                           "header_type": "UInt64"}, "VTKFile")
    grid = root.find("UnstructuredGrid")
    piece = grid.find("Piece")
    out = {"time": float(grid.find("FieldData/DataArray").text)}
    for group in ("PointData", "CellData", "Points", "Cells"):
        out.update({array.get("Name"): vtk_array(array) for array in piece.find(group)})
    demand(len(out["Points"]) == int(piece.get("NumberOfPoints")), "NumberOfPoints")
    demand(len(out["types"]) == len(out["offsets"]) == int(piece.get("NumberOfCells")), "NumberOfCells")
    demand(all(len(out[name]) == len(out["Points"]) for name in ("displacement", "velocity", "stress")),
           "point data")
    demand(len(out["body"]) == len(out["types"]), "cell data")
    sizes = np.diff(out["offsets"], prepend=0)
    demand(set(out["types"]) <= {5, 10}, "types")
    demand(np.array_equal(sizes, np.where(out["types"] == 10, 4, 3)), "offsets")
    demand(out["connectivity"].min() >= 0 and out["connectivity"].max() < len(out["Points"]), "connectivity")
    return out


def read_pvd(path):
    """Returns a list of (time, name)."""
    root = ET.parse(path).getroot()
    demand(root.get("type") == "Collection", "type")
    return [(float(one.get("timestep")), one.get("file")) for one in root.find("Collection")]


# --- surfaces -----------------------------------------------------------------------------------------------

def read_obj(path):
    """Returns a list of {"name", "points", "faces"}; faces count from zero in the object's own points."""
    objects, before = [], 0
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        word, _, rest = line.partition(" ")
        if word == "o":
            demand(" " not in rest, "a name is one word")
            before += len(objects[-1]["points"]) if objects else 0
            objects.append({"name": rest, "points": [], "faces": []})
        elif word == "v":
            objects[-1]["points"].append([float(x) for x in rest.split()])
        elif word == "f":
            objects[-1]["faces"].append([int(i) - 1 - before for i in rest.split()])
        else:
            demand(word == "#", line)
    for one in objects:
        one["points"], one["faces"] = np.array(one["points"]), np.array(one["faces"])
        demand(one["faces"].min() >= 0 and one["faces"].max() < len(one["points"]), "faces")
    return objects


PLY = {"float": "<f4", "uchar": "u1", "int": "<i4"}


def read_ply(path):
    """Returns {"vertices": a table by property, "faces", "comments"}."""
    raw = Path(path).read_bytes()
    end = raw.index(b"end_header\n") + len(b"end_header\n")
    header = raw[:end].decode("utf-8").splitlines()
    demand(header[:2] == ["ply", "format binary_little_endian 1.0"], "header")
    counts = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element ")}
    table = np.dtype([(line.split()[2], PLY[line.split()[1]]) for line in header
                      if line.startswith("property ") and "list" not in line])
    demand("property list uchar int vertex_indices" in header, "faces")
    vertices = np.frombuffer(raw, table, counts["vertex"], end)
    triangle = np.dtype([("n", "u1"), ("v", "<i4", 3)])
    faces = np.frombuffer(raw, triangle, counts["face"], end + vertices.nbytes)
    demand(len(raw) == end + vertices.nbytes + faces.nbytes, "length")
    demand((faces["n"] == 3).all() and faces["v"].min() >= 0 and faces["v"].max() < len(vertices), "faces")
    comments = [line[8:] for line in header if line.startswith("comment ")]
    return {"vertices": vertices, "faces": faces["v"], "comments": comments}


# --- glTF 2.0 -----------------------------------------------------------------------------------------------

WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
COMPONENT = {5126: "<f4", 5125: "<u4"}


def chunks_of(raw):
    magic, version, length = struct.unpack_from("<4sII", raw)
    demand((magic, version, length) == (b"glTF", 2, len(raw)), "header")
    at, out = 12, []
    while at < len(raw):
        size, kind = struct.unpack_from("<I4s", raw, at)
        demand(size % 4 == 0 and at + 8 + size <= len(raw), "chunk")
        out.append((kind, raw[at + 8:at + 8 + size]))
        at += 8 + size
    demand([kind for kind, _ in out] == [b"JSON", b"BIN\0"], "chunks")
    return out[0][1], out[1][1]


class Gltf:
    """A document with its accessors read; the constructor checks the requirements of the specification."""

    def __init__(self, path):
        text, self.binary = chunks_of(Path(path).read_bytes())
        self.json = json.loads(text.decode("utf-8"))
        demand(self.json["asset"]["version"] == "2.0", "asset")
        buffer, = self.json["buffers"]
        demand("uri" not in buffer and 0 <= len(self.binary) - buffer["byteLength"] < 4, "buffer")
        self.values = [self.accessor(one) for one in self.json["accessors"]]
        used = {one["bufferView"] for one in self.json["accessors"]}
        demand(used == set(range(len(self.json["bufferViews"]))), "views that nothing uses")
        for mesh in self.json["meshes"]:
            self.check_mesh(mesh)
        self.check_nodes()
        for animation in self.json.get("animations", []):
            self.check_animation(animation)

    def accessor(self, one):
        view = self.json["bufferViews"][one["bufferView"]]
        demand(view["buffer"] == 0 and view["byteOffset"] % 4 == 0, "alignment")
        demand(view["byteOffset"] + view["byteLength"] <= self.json["buffers"][0]["byteLength"], "view")
        width = WIDTH[one["type"]]
        demand(one["count"] > 0 and one["count"] * width * 4 <= view["byteLength"], "accessor")
        values = np.frombuffer(self.binary, COMPONENT[one["componentType"]], one["count"] * width,
                               view["byteOffset"]).reshape(-1, width)
        demand(np.isfinite(values).all(), "a value is not finite")
        for key, extreme in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
            if key in one:
                demand(np.array_equal(np.array(one[key], values.dtype), extreme), key)
        return values

    def demand_accessor(self, index, kind, component, bounded, target):
        one = self.json["accessors"][index]
        demand((one["type"], one["componentType"]) == (kind, component), f"accessor {index}")
        demand(("min" in one and "max" in one) or not bounded, f"accessor {index} lacks min and max")
        demand(self.json["bufferViews"][one["bufferView"]].get("target") == target, f"target of {index}")
        return self.values[index]

    def check_mesh(self, mesh):
        primitive, = mesh["primitives"]
        points = self.demand_accessor(primitive["attributes"]["POSITION"], "VEC3", 5126, True, 34962)
        corners = self.demand_accessor(primitive["indices"], "SCALAR", 5125, False, 34963)
        demand(primitive.get("mode", 4) == 4 and len(corners) % 3 == 0, "triangles")
        demand(corners.max() < len(points), "indices")
        demand(0 <= primitive["material"] < len(self.json["materials"]), "material")
        targets = primitive.get("targets", [])
        demand(len(mesh.get("weights", [])) == len(targets), "weights")
        for target in targets:
            moved = self.demand_accessor(target["POSITION"], "VEC3", 5126, True, 34962)
            demand(len(moved) == len(points), "morph target")

    def check_nodes(self):
        nodes = self.json["nodes"]
        children = [child for node in nodes for child in node.get("children", [])]
        demand(len(children) == len(set(children)), "a node has two parents")
        roots = self.json["scenes"][self.json["scene"]]["nodes"]
        demand(sorted(roots + children) == list(range(len(nodes))), "nodes outside the scene")
        for node in nodes:
            demand(abs(np.linalg.norm(node.get("rotation", [0, 0, 0, 1])) - 1) < 1e-6, "rotation")
            demand(node.get("mesh", 0) in range(len(self.json["meshes"])), "mesh")

    def check_animation(self, animation):
        targets = [(c["target"]["node"], c["target"]["path"]) for c in animation["channels"]]
        demand(len(targets) == len(set(targets)), "two channels of one property")
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            times = self.demand_accessor(sampler["input"], "SCALAR", 5126, True, None)[:, 0]
            demand(times[0] >= 0 and (np.diff(times) > 0).all(), "times")
            node, path = channel["target"]["node"], channel["target"]["path"]
            kind = {"weights": "SCALAR", "translation": "VEC3", "rotation": "VEC4"}[path]
            values = self.demand_accessor(sampler["output"], kind, 5126, False, None)
            size = len(times)
            if path == "weights":
                size *= len(self.json["meshes"][self.json["nodes"][node]["mesh"]]["weights"])
            demand(len(values) == size, f"keyframes of {path}")
            if path == "rotation":
                demand(np.allclose(np.linalg.norm(values, axis=1), 1, atol=1e-6), "unit quaternions")

    def times(self):
        animation, = self.json["animations"]
        return self.values[animation["samplers"][0]["input"]][:, 0]

    def animated(self, node, path, key):
        """Returns the value at a keyframe; the node's own value if no channel refers to it."""
        for animation in self.json.get("animations", []):
            for channel in animation["channels"]:
                if channel["target"] == {"node": node, "path": path}:
                    values = self.values[animation["samplers"][channel["sampler"]]["output"]]
                    return values.reshape(len(self.times()), -1)[key].astype(float)
        return self.json["nodes"][node].get(path)

    def shown(self, name, key):
        """Returns positions of a surface at a keyframe, as a viewer shows them."""
        node, = [i for i, one in enumerate(self.json["nodes"]) if one["name"] == name]
        mesh = self.json["meshes"][self.json["nodes"][node]["mesh"]]
        primitive = mesh["primitives"][0]
        points = self.values[primitive["attributes"]["POSITION"]].astype(float)
        weights = self.animated(node, "weights", key)
        for weight, target in zip([] if weights is None else weights, primitive.get("targets", [])):
            points = points + weight * self.values[target["POSITION"]]
        while node is not None:
            rotation = self.animated(node, "rotation", key)
            points = points @ matrix([0, 0, 0, 1] if rotation is None else rotation).T
            translation = self.animated(node, "translation", key)
            points = points + np.array([0, 0, 0] if translation is None else translation)
            node = next((i for i, one in enumerate(self.json["nodes"])
                         if node in one.get("children", [])), None)
        return points

    def faces(self, name):
        mesh, = [one for one in self.json["meshes"] if one["name"] == name]
        return self.values[mesh["primitives"][0]["indices"]].reshape(-1, 3)


def matrix(q):
    """Rotation matrix of a quaternion x, y, z, w."""
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def z_up(points):
    """Converts from glTF's y up back to z up."""
    return points @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]).T
