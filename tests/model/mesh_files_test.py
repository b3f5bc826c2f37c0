#!/usr/bin/env python3
"""Public mesh formats, feature by feature: each file has a volume and names known independently of palpate,
and becomes a model with these, or is rejected with its name. Prints the share of cases that are read
correctly. docs/meshes.md has a table of supported features; each of its cells is a case here.

    mesh_files_test.py PROGRAM [Class.test ...]
    mesh_files_test.py PROGRAM --share       prints each failing case, and the share, and exits with 0
"""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import mesh_files as m  # noqa: E402
import vtk_files as vtk  # noqa: E402

PALPATE = sys.argv.pop(1)
DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "meshes.md"

BOX, PLATE = m.Tets(), m.notched()
HALVES = {"soft tissue": 1.25e-4, "hard": 1.25e-4}
ALL = {"all": 2.5e-4, **HALVES}
NUMBERS = {"region-0": 1.25e-4, "region-1": 1.25e-4}
CASES = []


def case(format, feature, name, files, *options, volume=None, regions=None, refused=None, says=None):
    """files: text or bytes of `name`, or a dict of several files, of which `name` is passed to the
    program."""
    CASES.append({"format": format, "feature": feature, "name": name, "options": options, "regions": regions,
                  "files": files if isinstance(files, dict) else {name: files}, "volume": volume,
                  "refused": refused, "says": says})


def surface(format, feature, name, text, shape=PLATE, *options, **more):
    case(format, feature, name, text, "--tetrahedra", "1000", *options, **{"volume": shape.volume, **more})


def tets(format, feature, name, text, regions=None, **more):
    case(format, feature, name, text, **{"volume": BOX.volume, "regions": regions, **more})


def warped():
    out = m.block()
    out.points[6] = (.06, .06, .024)  # a corner of the top, raised by a fifth of the height
    # a fan from the first corner of the top (4 of 4 5 6 7), whose diagonal ends at the raised corner: two
    # tetrahedra
    out.volume += 2 * .06 * .06 / 2 * .004 / 3
    return out


# Wavefront
surface("OBJ", "triangles", "a.obj", m.obj(m.block().triangles()), m.block())
surface("OBJ", "quadrangles", "a.obj", m.obj(m.block()), m.block())
surface("OBJ", "concave polygons", "a.obj", m.obj(PLATE))
surface("OBJ", "polygons with a bridge to a hole", "a.obj", m.obj(m.pierced()), m.pierced())
surface("OBJ", "polygons that are not planar", "a.obj", m.obj(warped()), warped(), says="from a plane by")
surface("OBJ", "continued lines", "a.obj", m.obj(PLATE, lambda i, n: f"{i + 1} \\\n "))
surface("OBJ", "continued lines", "b.obj", "# from C:\\\n" + m.obj(PLATE, lambda i, n: f"{i + 1} \\\r\n "))
surface("OBJ", "numbers from the end", "a.obj", m.obj(PLATE, lambda i, n: str(i - n)))
surface("OBJ", "normals, textures, colours", "a.obj",
        m.obj(PLATE, lambda i, n: f"{i + 1}/1/1",
              "mtllib a.mtl\no thing\nvt 0 0\nvn 0 0 1\ng caps\nusemtl red\ns off\n", (.5, .5, .5)))
surface("OBJ", "normals, textures, colours", "b.obj", m.obj(PLATE, lambda i, n: f"{i + 1}//1", "vn 0 0 1\n"))
surface("OBJ", "line ends of other systems", "a.obj", m.obj(PLATE).replace("\n", "\r\n"))
surface("OBJ", "line ends of other systems", "b.obj", m.obj(PLATE).replace("\n", "\r"))
surface("OBJ", "byte order mark", "a.obj", "\ufeff" + m.obj(PLATE))
surface("OBJ", "millimetres", "a.obj", m.obj(PLATE.scaled(1000)), PLATE, "--scale", "0.001")
surface("OBJ", "millimetres, not said", "a.obj", m.obj(PLATE.scaled(1000)), volume=None,
        refused="for a file in millimetres, use --scale 0.001")

# PLY
surface("PLY", "triangles", "a.ply", m.ply(m.block().triangles()), m.block())
surface("PLY", "quadrangles", "a.ply", m.ply(m.block()), m.block())
surface("PLY", "concave polygons", "a.ply", m.ply(PLATE))
surface("PLY", "polygons with a bridge to a hole", "a.ply", m.ply(m.pierced()), m.pierced())
surface("PLY", "polygons that are not planar", "a.ply", m.ply(warped()), warped(), says="from a plane by")
surface("PLY", "bytes", "a.ply", m.ply(PLATE, "binary_little_endian"))
surface("PLY", "bytes", "b.ply", m.ply(PLATE, "binary_little_endian", "float", "uint"))
surface("PLY", "bytes of the other order", "a.ply", m.ply(PLATE, "binary_big_endian", "float"))
surface("PLY", "names of types and properties", "a.ply",
        m.ply(PLATE, "binary_little_endian", "float32", "int32", "uint8", "vertex_index"))
surface("PLY", "normals, textures, colours", "a.ply",
        m.ply(PLATE, "binary_little_endian", "float",
              more=[("float", "nx", 0.), ("float", "ny", 0.), ("float", "nz", 1.),
                    ("uchar", "red", 200), ("uchar", "green", 0), ("uchar", "blue", 7)]))
surface("PLY", "comments", "a.ply", m.ply(PLATE, head="comment made by hand\nobj_info nothing\n"))
surface("PLY", "line ends of other systems", "a.ply", m.ply(PLATE).replace("\n", "\r\n"))
surface("PLY", "millimetres", "a.ply", m.ply(PLATE.scaled(1000)), PLATE, "--scale", "0.001")

# OFF
surface("OFF", "triangles", "a.off", m.off(m.block().triangles()), m.block())
surface("OFF", "quadrangles", "a.off", m.off(m.block()), m.block())
surface("OFF", "concave polygons", "a.off", m.off(PLATE))
surface("OFF", "polygons with a bridge to a hole", "a.off", m.off(m.pierced()), m.pierced())
surface("OFF", "polygons that are not planar", "a.off", m.off(warped()), warped(), says="from a plane by")
surface("OFF", "normals, textures, colours", "a.off", m.off(PLATE, "COFF\n", (255, 0, 0, 255)))
surface("OFF", "normals, textures, colours", "b.off", m.off(PLATE, face_tail=(255, 0, 0)))
surface("OFF", "normals, textures, colours", "c.off", m.off(PLATE, "NOFF\n", (0., 0., 1.)))
surface("OFF", "comments", "a.off", m.off(PLATE, "OFF\n# made by hand\n\n"))
surface("OFF", "line ends of other systems", "a.off", m.off(PLATE).replace("\n", "\r\n"))
surface("OFF", "millimetres", "a.off", m.off(PLATE.scaled(1000)), PLATE, "--scale", "0.001")

# STL, of the block: fans are correct for convex faces only
surface("STL", "triangles", "a.stl", m.stl(m.block()), m.block())
surface("STL", "triangles", "b.stl", m.stl(m.block(), upper=True), m.block())
surface("STL", "bytes", "a.stl", m.stl_bytes(m.block()), m.block())
surface("STL", "bytes", "b.stl", m.stl_bytes(m.block(), b"solid by a program that writes bytes"), m.block())
surface("STL", "line ends of other systems", "a.stl", m.stl(m.block()).replace("\n", "\r\n"), m.block())
surface("STL", "millimetres", "a.stl", m.stl_bytes(m.block().scaled(1000)), m.block(), "--scale", "0.001")

# legacy VTK
for version in ("3.0", "5.1"):
    for binary in (False, True):
        way = "bytes" if binary else "tetrahedra"
        tets("VTK", way, f"t{version}{binary}.vtk", vtk.tets(version, binary))
        surface("VTK", "concave polygons", f"s{version}{binary}.vtk", vtk.surface(PLATE, version, binary))
        for labels in ("scalars", "field"):
            tets("VTK", "regions by number", f"{labels}{version}{binary}.vtk",
                 vtk.tets(version, binary, labels=labels), NUMBERS)
    surface("VTK", "triangle strips", f"p{version}.vtk", vtk.surface(m.block(), version, strips=True),
            m.block())
for binary in (False, True):
    tets("VTK", "version 5.1, indices of 32 bits", f"a{binary}.vtk",
         vtk.tets("5.1", binary, "vtktypeint32"))
    tets("VTK", "version 5.1, metadata", f"a{binary}.vtk", vtk.tets("5.1", binary, metadata=True))
surface("VTK", "polygons that are not planar", "a.vtk", vtk.surface(warped(), "5.1"), warped(),
        says="from a plane by")
tets("VTK", "line ends of other systems", "a.vtk", vtk.tets().replace(b"\n", b"\r\n"))
case("VTK", "second order", "a.vtk", vtk.tets(mesh=m.Tets(order=2), kind=24),
     refused="tetrahedra of second order")
surface("VTK", "millimetres", "a.vtk", vtk.surface(PLATE.scaled(1000)), PLATE, "--scale", "0.001")

# VTK's XML
tets("VTU, VTP", "tetrahedra", "a.vtu", vtk.vtu(BOX))
tets("VTU, VTP", "bytes", "a.vtu", vtk.vtu(BOX, form="binary"))
tets("VTU, VTP", "bytes", "b.vtu", vtk.vtu(BOX, form="appended"))
tets("VTU, VTP", "bytes", "c.vtu", vtk.vtu(BOX, form="appended", compressed=True))
tets("VTU, VTP", "bytes of the other order", "a.vtu", vtk.vtu(BOX, form="appended", big=True))
tets("VTU, VTP", "regions by number", "a.vtu", vtk.vtu(BOX, labels=True), NUMBERS)
tets("VTU, VTP", "several pieces", "a.vtu", vtk.vtu(m.Tets(), labels=True, parts=2, form="binary"), NUMBERS)
surface("VTU, VTP", "concave polygons", "a.vtp", vtk.vtp(PLATE))
surface("VTU, VTP", "concave polygons", "b.vtp", vtk.vtp(PLATE, form="appended", compressed=True))
surface("VTU, VTP", "polygons that are not planar", "a.vtp", vtk.vtp(warped()), warped(),
        says="from a plane by")
case("VTU, VTP", "second order", "a.vtu", vtk.vtu(m.Tets(order=2), kind=24),
     refused="tetrahedra of second order")
surface("VTU, VTP", "millimetres", "a.vtp", vtk.vtp(PLATE.scaled(1000)), PLATE, "--scale", "0.001")

# Gmsh
for binary in (False, True):
    way = "bytes" if binary else "tetrahedra"
    tets("Gmsh 2.2", way, f"a{binary}.msh", m.msh2(BOX, names="", groups=lambda half: (0,), binary=binary),
         {"region-1": 1.25e-4, "region-2": 1.25e-4})
    tets("Gmsh 2.2", "regions by name", f"a{binary}.msh", m.msh2(BOX, binary=binary), HALVES)
    tets("Gmsh 2.2", "elements in several regions", f"a{binary}.msh",
         m.msh2(BOX, lambda half: (1, 2 + half), binary=binary), ALL)
    tets("Gmsh 2.2", "regions by number", f"a{binary}.msh", m.msh2(BOX, names="", binary=binary),
         {"region-2": 1.25e-4, "region-3": 1.25e-4})
    tets("Gmsh 4.1", way, f"b{binary}.msh", m.msh4(BOX, ((), ()), "", binary),
         {"region-1": 1.25e-4, "region-2": 1.25e-4})
    tets("Gmsh 4.1", "regions by name", f"b{binary}.msh", m.msh4(BOX, ((2,), (3,)), binary=binary), HALVES)
    tets("Gmsh 4.1", "elements in several regions", f"b{binary}.msh", m.msh4(BOX, binary=binary), ALL)
    tets("Gmsh 4.1", "regions by number", f"b{binary}.msh", m.msh4(BOX, ((2,), (3,)), "", binary),
         {"region-2": 1.25e-4, "region-3": 1.25e-4})
    tets("Gmsh 4.1", "partitions", f"b{binary}.msh", m.msh4(BOX, binary=binary, partitioned=True), ALL)
tets("Gmsh 2.2", "partitions", "a.msh", m.msh2(BOX, lambda half: (1, 2 + half), partitioned=True), ALL)
surface("Gmsh 2.2", "quadrangles", "a.msh", m.msh_surface(m.block()), m.block())
case("Gmsh 2.2", "second order", "a.msh", m.msh2(m.Tets(order=2), kind=11), refused="second order")
case("Gmsh 4.1", "second order", "a.msh", m.msh4(m.Tets(order=2), kind=11), refused="second order")
tets("Gmsh 2.2", "line ends of other systems", "a.msh", m.msh2(BOX).replace(b"\n", b"\r\n"), HALVES)
tets("Gmsh 4.1", "line ends of other systems", "a.msh", m.msh4(BOX).replace(b"\n", b"\r\n"), ALL)

# TetGen, Medit
for first in (0, 1):
    node, ele = m.tetgen(BOX, first)
    tets("TetGen", "tetrahedra", f"a{first}.node", {f"a{first}.node": node, f"a{first}.ele": ele})
node, ele = m.tetgen(BOX, 1, True, "# made by hand\n")
tets("TetGen", "regions by number", "b.ele", {"b.node": node, "b.ele": ele}, NUMBERS)
tets("TetGen", "comments", "b.node", {"b.node": node, "b.ele": "# cells\n" + ele + "# the end\n"}, NUMBERS)
node, ele = m.tetgen(m.Tets(order=2))
case("TetGen", "second order", "c.node", {"c.node": node, "c.ele": ele}, refused="10 nodes per tetrahedron")
REFERENCES = {"region-1": 1.25e-4, "region-2": 1.25e-4}
tets("Medit", "tetrahedra", "a.mesh", m.medit(BOX))
tets("Medit", "regions by number", "b.mesh", m.medit(BOX), REFERENCES)
tets("Medit", "bytes", "a.meshb", m.medit_bytes(BOX), REFERENCES)
tets("Medit", "bytes of the other order", "a.meshb", m.medit_bytes(BOX, ">"), REFERENCES)


def outcome(case):
    """Returns the fault of a case; empty if there is none."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in case["files"].items():
            Path(folder, name).write_bytes(content.encode() if isinstance(content, str) else content)
        make = [PALPATE, "model", case["name"], "-o", "out.h5", "--proxies", "0", *case["options"]]
        done = subprocess.run(make, cwd=folder, capture_output=True, text=True, timeout=120)
        left = {p.name for p in Path(folder).iterdir()} - set(case["files"]) - {"out.h5"}
    if left:
        return f"leaves {left}"
    if case["refused"]:
        if done.returncode == 1 and case["refused"] in done.stderr:
            return ""
        return f"status {done.returncode}: {done.stderr.strip()[:200]}"
    if done.returncode != 0:
        return f"status {done.returncode}: {done.stderr.strip()[:200]}"
    row = re.search(r"^volume \[m\^3\] +(\S+)", done.stdout, re.M)
    volume = float(row.group(1))
    # the boundary of a filled surface is fitted to its volume: the gate permits 1 %
    tolerance = 1e-2 if "--tetrahedra" in case["options"] else 1e-5
    if abs(volume / case["volume"] - 1) > tolerance:
        return f"volume {volume}, right is {case['volume']:.6g}"
    if case["says"] and case["says"] not in done.stdout:
        return f"does not say \"{case['says']}\""
    if case["regions"] is not None:
        found = {r[0]: float(r[1]) for r in re.findall(r"^(\S.*?)  +\d+ +(\S+) +-$", done.stdout, re.M)}
        if found.keys() != case["regions"].keys() or \
                any(abs(found[name] / case["regions"][name] - 1) > 1e-5 for name in found):
            return f"regions {found}, right are {case['regions']}"
    return ""


class Files(unittest.TestCase):
    def test_every_case_is_read_right(self):
        kinds = {(c["format"], c["feature"]) for c in CASES}
        self.assertGreaterEqual(len(kinds), 40)
        wrong = []
        for c in CASES:
            what = outcome(c)
            if what:
                wrong.append((c["format"], c["feature"], c["name"], what))
        right = len(CASES) - len(wrong)
        print(f"{right} of {len(CASES)} files of {len(kinds)} kinds are read right", file=sys.stderr)
        self.assertEqual(wrong, [])

    def test_the_table_of_the_page_has_these_cases_and_no_others(self):
        rows = [[cell.strip() for cell in line.strip("|\n").split("|")]
                for line in DOCUMENT.read_text(encoding="utf-8").splitlines() if line.startswith("|")]
        start = next(i for i, row in enumerate(rows) if row[0] == "feature")
        formats, found = rows[start][1:], {}
        for row in rows[start + 2:]:
            if len(row) != len(formats) + 1:
                break
            found.update({(f, row[0]): cell for f, cell in zip(formats, row[1:]) if cell})
        wanted = {(c["format"], c["feature"]): "refused" if c["refused"] else "yes" for c in CASES}
        self.assertEqual(found, wanted)


def print_table():
    """Prints the table of docs/meshes.md."""
    formats = list(dict.fromkeys(c["format"] for c in CASES))
    features = list(dict.fromkeys(c["feature"] for c in CASES))
    cells = {(c["format"], c["feature"]): "refused" if c["refused"] else "yes" for c in CASES}
    print("| feature | " + " | ".join(formats) + " |\n" + "|---" * (len(formats) + 1) + "|")
    for feature in features:
        print(f"| {feature} | " + " | ".join(cells.get((f, feature), "") for f in formats) + " |")


if __name__ == "__main__":
    if "--table" in sys.argv:
        print_table()
    elif "--share" in sys.argv:
        failed = [(c, what) for c in CASES if (what := outcome(c))]
        for c, what in failed:
            print(f"{c['format']}, {c['feature']}, {c['name']}: {what}")
        print(f"{len(CASES) - len(failed)} of {len(CASES)} files are read right")
    else:
        unittest.main()
