"""Writers of VTK's mesh files, legacy and XML, in pure Python."""
import base64
import struct
import zlib

from mesh_files import Tets, lines


class Vtk:
    """Legacy files: version 3 to 5.1, as text or binary."""

    def __init__(self, version, binary, kind, index="vtktypeint64"):
        self.version, self.binary, self.index = version, binary, index
        self.out = (f"# vtk DataFile Version {version}\na title\n{'BINARY' if binary else 'ASCII'}\n"
                    f"DATASET {kind}\n").encode()

    def values(self, values, code, per_line=9):
        if self.binary:
            self.out += struct.pack(f">{len(values)}{code}", *values) + b"\n"
        else:
            rows = [values[i:i + per_line] for i in range(0, len(values), per_line)]
            self.out += lines(rows).encode()
        return self

    def text(self, text):
        self.out += text.encode()
        return self

    def points(self, points, real="double"):
        self.text(f"POINTS {len(points)} {real}\n")
        return self.values([float(x) for p in points for x in p], "d" if real == "double" else "f")

    def metadata(self):
        return self.text("METADATA\nINFORMATION 2\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 0.15\n"
                         "NAME L2_NORM_FINITE_RANGE LOCATION vtkDataArray\nDATA 2 0 0.15\n\n")

    def cells(self, cells, keyword="CELLS"):
        flat = [i for c in cells for i in c]
        if float(self.version) < 5:
            self.text(f"{keyword} {len(cells)} {len(flat) + len(cells)}\n")
            return self.values([x for c in cells for x in (len(c), *c)], "i")
        code = "q" if self.index.endswith("64") else "i"
        offsets = [0]
        for c in cells:
            offsets.append(offsets[-1] + len(c))
        self.text(f"{keyword} {len(offsets)} {len(flat)}\nOFFSETS {self.index}\n").values(offsets, code)
        return self.text(f"CONNECTIVITY {self.index}\n").values(flat, code)

    def types(self, types):
        return self.text(f"CELL_TYPES {len(types)}\n").values(types, "i", 1)


def tets(version="3.0", binary=False, index="vtktypeint64", metadata=False, labels="", kind=10,
         mesh=None):
    mesh = mesh or Tets()
    file = Vtk(version, binary, "UNSTRUCTURED_GRID", index).points(mesh.points)
    if metadata:
        file.metadata()
    file.cells(mesh.cells).types([kind] * len(mesh.cells))
    if labels == "scalars":
        file.text(f"CELL_DATA {len(mesh.half)}\nSCALARS CellEntityIds int 1\nLOOKUP_TABLE default\n")
        file.values(mesh.half, "i")
    if labels == "field":
        file.text(f"CELL_DATA {len(mesh.half)}\nFIELD FieldData 2\nquality 1 {len(mesh.half)} double\n")
        file.values([.5] * len(mesh.half), "d")
        file.metadata().text(f"MaterialIds 1 {len(mesh.half)} int\n").values(mesh.half, "i")
    return file.out


def surface(s, version="3.0", binary=False, index="vtktypeint64", strips=False):
    file = Vtk(version, binary, "POLYDATA", index).points(s.points, "float")
    if strips:  # the sides of a prism with n corners as one strip, its caps as polygons
        n = len(s.points) // 2
        strip = [i % n + at for i in range(n + 1) for at in (n, 0)]
        return file.cells(s.faces[:2], "POLYGONS").cells([strip], "TRIANGLE_STRIPS").out
    return file.cells(s.faces, "POLYGONS").out


def xml(kind, pieces, form="ascii", compressed=False, big=False):
    """pieces: (points, {section: [(name, type, components, values)]}, sizes)."""
    codes = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}
    appended = b""
    body = ""

    def packed(code, values):
        data = struct.pack((">" if big else "<") + f"{len(values)}{code}", *values)
        order = ">" if big else "<"
        if not compressed:
            return struct.pack(order + "Q", len(data)), data
        small = zlib.compress(data)
        return struct.pack(order + "4Q", 1, len(data), 0, len(small)), small

    def array(name, kind_of, components, values):
        nonlocal appended
        head = f'<DataArray type="{kind_of}" Name="{name}" NumberOfComponents="{components}" format="{form}"'
        if form == "ascii":
            return head + ">" + " ".join(map(repr, values)) + "</DataArray>"
        header, data = packed(codes[kind_of], values)
        if form == "binary":
            return head + ">" + (base64.b64encode(header) + base64.b64encode(data)).decode() + "</DataArray>"
        head += f' offset="{len(appended)}"/>'
        appended += header + data
        return head
    for points, sections, sizes in pieces:
        body += f"<Piece {sizes}><Points>"
        body += array("Points", "Float64", 3, [float(x) for p in points for x in p]) + "</Points>"
        for section, arrays in sections.items():
            body += f"<{section}>" + "".join(array(*a) for a in arrays) + f"</{section}>"
        body += "</Piece>"
    compressor = ' compressor="vtkZLibDataCompressor"' if compressed else ""
    order = "BigEndian" if big else "LittleEndian"
    text = (f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="{order}" '
            f'header_type="UInt64"{compressor}><{kind}>{body}</{kind}>')
    if form == "appended":
        return text.encode() + b'<AppendedData encoding="raw">_' + appended + b"</AppendedData></VTKFile>"
    return text + "</VTKFile>"


def connected(cells, extra=()):
    ends, total = [], 0
    for c in cells:
        total += len(c)
        ends.append(total)
    flat = [i for c in cells for i in c]
    return [("connectivity", "Int64", 1, flat), ("offsets", "Int64", 1, ends), *extra]


def vtu(mesh, labels=False, parts=1, kind=10, **how):
    pieces = []
    n = len(mesh.cells)
    for part in range(parts):
        own = range(part * n // parts, (part + 1) * n // parts)
        cells = [mesh.cells[c] for c in own]
        sections = {"Cells": connected(cells, [("types", "UInt8", 1, [kind] * len(cells))])}
        if labels:
            sections["CellData"] = [("MaterialIds", "Int32", 1, [mesh.half[c] for c in own])]
        sizes = f'NumberOfPoints="{len(mesh.points)}" NumberOfCells="{len(cells)}"'
        pieces.append((mesh.points, sections, sizes))
    return xml("UnstructuredGrid", pieces, **how)


def vtp(s, **how):
    return xml("PolyData", [(s.points, {"Polys": connected(s.faces)},
                             f'NumberOfPoints="{len(s.points)}" NumberOfPolys="{len(s.faces)}"')], **how)
