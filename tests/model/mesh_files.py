"""Writers of mesh files in the formats that palpate reads, in pure Python, each with a known volume; those of
VTK are in vtk_files.py.

Shapes are extrusions of polygons and boxes of tetrahedra: their volumes are products of lengths, and a notch
or a hole that is closed by mistake changes them by a tenth or more.
"""
import struct

# ---- shapes --------------------------------------------------------------------------------------------

NOTCHED = [(0, 0), (.06, 0), (.06, .06), (.04, .06), (.04, .02), (.02, .02), (.02, .06), (0, .06)]
# starts at the corner about which a fan would leave the outline
NOTCHED = NOTCHED[2:] + NOTCHED[:2]
SQUARE = [(0, 0), (.06, 0), (.06, .06), (0, .06)]
HOLE = [(.02, .02), (.02, .04), (.04, .04), (.04, .02)]  # in the opposite direction


def area(outline):
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(outline, outline[1:] + outline[:1])) / 2


class Surface:
    def __init__(self, points, faces, volume):
        self.points, self.faces, self.volume = points, faces, volume

    def scaled(self, by):
        return Surface([[by * x for x in p] for p in self.points], self.faces, self.volume * by ** 3)

    def triangles(self):
        """Triangulates by fans: correct for convex faces only."""
        return Surface(self.points, [(f[0], f[i], f[i + 1]) for f in self.faces
                                     for i in range(1, len(f) - 1)], self.volume)


def extruded(outline, height=.02):
    n = len(outline)
    points = [(x, y, z) for z in (0, height) for x, y in outline]
    sides = [(i, (i + 1) % n, (i + 1) % n + n, i + n) for i in range(n)]
    caps = [tuple(range(n - 1, -1, -1)), tuple(range(n, 2 * n))]
    return Surface(points, caps + sides, area(outline) * height)


def pierced(height=.02):
    """A square tube: each cap is one polygon that reaches the hole and returns along the same edge."""
    points = [(x, y, z) for z in (0, height) for x, y in SQUARE + HOLE]
    top = [8, 9, 10, 11, 8, 12, 13, 14, 15, 12]
    sides = [(i, (i + 1) % 4, (i + 1) % 4 + 8, i + 8) for i in range(4)]
    sides += [(4 + i, 4 + (i + 1) % 4, 12 + (i + 1) % 4, 12 + i) for i in range(4)]
    return Surface(points, [tuple(i - 8 for i in reversed(top)), tuple(top)] + sides,
                   (area(SQUARE) + area(HOLE)) * height)


def notched():
    return extruded(NOTCHED)


def block():
    return extruded(SQUARE)


class Tets:
    """A box of 0.1 x 0.05 x 0.05 m, divided into cubes of six tetrahedra; `half` is 0 or 1, by x."""

    def __init__(self, cells=2, order=1):
        h = .05 / cells
        index = {}
        self.points, self.cells, self.half = [], [], []

        def node(i, j, k):
            key = (i, j, k)
            if key not in index:
                index[key] = len(self.points)
                self.points.append((i * h, j * h, k * h))
            return index[key]
        paths = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
        for i in range(2 * cells):
            for j in range(cells):
                for k in range(cells):
                    for n, path in enumerate(paths):
                        at, corners = [i, j, k], [node(i, j, k)]
                        for axis in path:
                            at[axis] += 1
                            corners.append(node(*at))
                        if n in (1, 2, 5):  # odd permutations have the opposite orientation
                            corners[2], corners[3] = corners[3], corners[2]
                        self.cells.append(tuple(corners))
                        self.half.append(int(i >= cells))
        self.volume = .1 * .05 * .05
        if order == 2:
            self.second_order()

    def second_order(self):
        middle = {}
        edges = [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)]
        for c, cell in enumerate(self.cells):
            more = []
            for a, b in edges:
                key = tuple(sorted((cell[a], cell[b])))
                if key not in middle:
                    middle[key] = len(self.points)
                    self.points.append(tuple((x + y) / 2 for x, y in zip(*(self.points[i] for i in key))))
                more.append(middle[key])
            self.cells[c] = cell + tuple(more)


def lines(rows):
    def word(x):
        return format(x, ".17g") if isinstance(x, float) else str(x)
    return "".join(" ".join(map(word, row)) + "\n" for row in rows)


# ---- surfaces ------------------------------------------------------------------------------------------

def obj(s, corner=lambda i, n: str(i + 1), extra="", tail=()):
    n = len(s.points)
    return extra + lines(("v", *map(float, p), *tail) for p in s.points) + \
        lines(("f", *(corner(i, n) for i in f)) for f in s.faces)


def ply(s, form="ascii", real="double", index="int", count="uchar", name="vertex_indices", more=(), head=""):
    """more: additional vertex properties, (type, name, value)."""
    codes = {"double": "d", "float64": "d", "float": "f", "float32": "f", "int": "i", "int32": "i",
             "uint": "I", "uint32": "I", "uchar": "B", "uint8": "B", "ushort": "H", "short": "h"}
    text = f"ply\nformat {form} 1.0\n{head}element vertex {len(s.points)}\n"
    text += "".join(f"property {real} {axis}\n" for axis in "xyz")
    text += "".join(f"property {t} {n}\n" for t, n, _ in more)
    text += f"element face {len(s.faces)}\nproperty list {count} {index} {name}\nend_header\n"
    if form == "ascii":
        return text + lines((*map(float, p), *(v for _, _, v in more)) for p in s.points) + \
            lines((len(f), *f) for f in s.faces)
    order = "<" if "little" in form else ">"
    out = text.encode()
    for p in s.points:
        out += struct.pack(order + 3 * codes[real], *p)
        out += b"".join(struct.pack(order + codes[t], v) for t, _, v in more)
    for f in s.faces:
        out += struct.pack(order + codes[count] + len(f) * codes[index], len(f), *f)
    return out


def off(s, head="OFF\n", tail=(), face_tail=()):
    return f"{head}{len(s.points)} {len(s.faces)} 0\n" + lines((*map(float, p), *tail) for p in s.points) + \
        lines((len(f), *f, *face_tail) for f in s.faces)


def stl(s, solid="solid a\n", upper=False):
    out = solid
    for f in s.triangles().faces:
        out += "facet normal 0 0 0\n outer loop\n"
        out += lines(("  vertex", *map(float, s.points[i])) for i in f) + " endloop\nendfacet\n"
    out += "endsolid a\n"
    return out.upper() if upper else out


def stl_bytes(s, head=b""):
    faces = s.triangles().faces
    return head.ljust(80) + struct.pack("<I", len(faces)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for i in f for x in s.points[i]), 0) for f in faces)


# ---- Gmsh ----------------------------------------------------------------------------------------------

NAMES = '$PhysicalNames\n3\n3 1 "all"\n3 2 "soft tissue"\n3 3 "hard"\n$EndPhysicalNames\n'


def msh2(mesh, groups=lambda half: (2 + half,), names=NAMES, binary=False, partitioned=False, kind=4):
    """groups: physical numbers of an element, which occurs in the file once for each."""
    out = f"$MeshFormat\n2.2 {int(binary)} 8\n".encode() + (struct.pack("<i", 1) + b"\n" if binary else b"")
    out += b"$EndMeshFormat\n" + names.encode() + f"$Nodes\n{len(mesh.points)}\n".encode()
    for i, p in enumerate(mesh.points):
        out += struct.pack("<i3d", i + 1, *p) if binary else lines([(i + 1, *map(float, p))]).encode()
    rows = [(group, 1 + half, cell) for cell, half in zip(mesh.cells, mesh.half) for group in groups(half)]
    out += (b"\n" if binary else b"") + f"$EndNodes\n$Elements\n{len(rows)}\n".encode()
    for number, (group, volume, cell) in enumerate(rows, 1):
        tags = (group, volume, 1, 1 + number % 2) if partitioned else (group, volume)
        corners = [i + 1 for i in cell]
        if binary:
            entries = (kind, 1, len(tags), number, *tags, *corners)
            out += struct.pack(f"<{len(entries)}i", *entries)
        else:
            out += lines([(number, kind, len(tags), *tags, *corners)]).encode()
    return out + (b"\n" if binary else b"") + b"$EndElements\n"


def msh4(mesh, groups=((1, 2), (1, 3)), names=NAMES, binary=False, partitioned=False, kind=4):
    """groups: physical numbers of each half. partitioned: each half in two parts, which have the groups."""
    def size(*values):
        return struct.pack(f"<{len(values)}Q", *values) if binary else lines([values])[:-1].encode() + b" "

    def whole(*values):
        return struct.pack(f"<{len(values)}i", *values) if binary else lines([values])[:-1].encode() + b" "

    def real(*values):
        if binary:
            return struct.pack(f"<{len(values)}d", *values)
        return lines([map(float, values)])[:-1].encode() + b" "
    end = b"" if binary else b"\n"
    out = f"$MeshFormat\n4.1 {int(binary)} 8\n".encode() + (struct.pack("<i", 1) + b"\n" if binary else b"")
    out += b"$EndMeshFormat\n" + names.encode() + b"$Entities\n" + size(0, 0, 0, 2) + end
    box = (0, 0, 0, .1, .05, .05)
    for half in (0, 1):
        out += whole(1 + half) + real(*box) + size(len(groups[half])) + whole(*groups[half]) + size(0) + end
    out += (b"\n" if binary else b"") + b"$EndEntities\n"
    blocks = [(1 + half, [c for c in range(len(mesh.cells)) if mesh.half[c] == half]) for half in (0, 1)]
    if partitioned:
        out += b"$PartitionedEntities\n" + size(2) + end + size(0) + end + size(0, 0, 0, 4) + end
        blocks = [(10 + 2 * half + part, own[part::2]) for half, (_, own) in enumerate(blocks)
                  for part in (0, 1)]
        for tag, _ in blocks:
            half, part = divmod(tag - 10, 2)
            out += whole(tag, 3, 1 + half) + size(1) + whole(1 + part) + real(*box) + size(len(groups[half]))
            out += whole(*groups[half]) + size(0) + end
        out += (b"\n" if binary else b"") + b"$EndPartitionedEntities\n"
    n = len(mesh.points)
    out += b"$Nodes\n" + size(1, n, 1, n) + end + whole(3, blocks[0][0], 0) + size(n) + end
    for i in range(n):
        out += size(i + 1) + end
    for p in mesh.points:
        out += real(*p) + end
    out += (b"\n" if binary else b"") + b"$EndNodes\n$Elements\n"
    out += size(len(blocks), len(mesh.cells), 1, len(mesh.cells)) + end
    for tag, own in blocks:
        out += whole(3, tag, kind) + size(len(own)) + end
        for c in own:
            out += size(c + 1, *(i + 1 for i in mesh.cells[c])) + end
    return out + (b"\n" if binary else b"") + b"$EndElements\n"


def msh_surface(s):
    out = f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(s.points)}\n"
    out += lines((i + 1, *map(float, p)) for i, p in enumerate(s.points))
    out += f"$EndNodes\n$Elements\n{len(s.faces)}\n"
    return out + lines((n + 1, {3: 2, 4: 3}[len(f)], 2, 0, 1, *(i + 1 for i in f))
                       for n, f in enumerate(s.faces)) + "$EndElements\n"


# ---- TetGen, Medit -------------------------------------------------------------------------------------

def tetgen(mesh, first=0, attributes=False, comment=""):
    node = comment + f"{len(mesh.points)} 3 0 0\n" + lines((i + first, *map(float, p))
                                                            for i, p in enumerate(mesh.points))
    ele = f"{len(mesh.cells)} {len(mesh.cells[0])} {int(attributes)}\n"
    ele += lines((i + first, *(c + first for c in cell), *((half,) if attributes else ()))
                 for i, (cell, half) in enumerate(zip(mesh.cells, mesh.half)))
    return node, ele


def medit(mesh):
    return f"MeshVersionFormatted 2\nDimension 3\nVertices\n{len(mesh.points)}\n" + \
        lines((*map(float, p), 0) for p in mesh.points) + f"Tetrahedra\n{len(mesh.cells)}\n" + \
        lines((*(i + 1 for i in c), 1 + h) for c, h in zip(mesh.cells, mesh.half)) + "End\n"


def medit_bytes(mesh, order="<"):
    def block(keyword, content, at):
        return struct.pack(order + "2i", keyword, at + 8 + len(content)) + content
    out = struct.pack(order + "2i", 1, 2)
    out += block(3, struct.pack(order + "i", 3), len(out))
    out += block(4, struct.pack(order + "i", len(mesh.points)) +
                 b"".join(struct.pack(order + "3di", *p, 0) for p in mesh.points), len(out))
    out += block(8, struct.pack(order + "i", len(mesh.cells)) +
                 b"".join(struct.pack(order + "5i", *(i + 1 for i in c), 1 + h)
                          for c, h in zip(mesh.cells, mesh.half)), len(out))
    return out + struct.pack(order + "2i", 54, 0)
