#!/usr/bin/env bash
# meshio (Debian 12: python3-meshio 7.0.0-3, which calls itself 5.0.0): the element types of an Abaqus input file (.inp).
#
# Expected: a cell goes to the plain element of its shape, which is also read as that cell: a hexahedron to C3D8, a
#   tetrahedron of ten nodes to C3D10, a triangle to a shell or membrane, S3.
# Seen: a hexahedron is written as C3D8RH (reduced integration, hybrid), ten nodes as C3D10MH, a triangle as R3D3
#   (a rigid facet), a quadrilateral as CAX4P (axisymmetric, with pore pressure); C3D8 read and written again is
#   C3D8RH.  The mesh is the same, its mechanics are not: stiffness, hourglasses, and no deformation of a skin.
package=python3-meshio version=7.0.0-3
set -euo pipefail
skip() { echo "cannot run here: $*"; exit 77; }
[[ -x /usr/bin/python3 ]] || skip "/usr/bin/python3 is missing"
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
if [[ $(dpkg-query -W -f='${Version}' "$package" 2>/dev/null) != "$version" ]]; then
  apt-get -s --no-install-recommends install "$package=$version" >plan 2>/dev/null ||
    skip "apt has no $package $version"
  sed -nE 's/^Inst ([^ ]+) .*\(([^ ]+) .*/\1=\2/p' plan | xargs apt-get download >/dev/null 2>&1 || skip "no network"
  for archive in *.deb; do dpkg -x "$archive" .; done
  lib=$folder/usr/lib/$(uname -m)-linux-gnu
  export PYTHONPATH=$folder/usr/lib/python3/dist-packages LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack
fi
/usr/bin/python3 - <<'END'
import re, sys
import meshio, numpy

def types(path):
    return re.findall(r"TYPE=(\w+)", open(path).read())

points = numpy.random.default_rng(1).random((10, 3))
seen = {}
for cell, nodes in (("tetra", 4), ("tetra10", 10), ("hexahedron", 8), ("triangle", 3), ("quad", 4)):
    meshio.write("mesh.inp", meshio.Mesh(points, [(cell, numpy.arange(nodes)[None])]))
    seen[cell] = types("mesh.inp")[0]
open("c3d8.inp", "w").write("*NODE\n" + "".join("%d, %g, %g, %g\n" % (i + 1, *p) for i, p in enumerate(points)) +
                            "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n")
meshio.write("again.inp", meshio.read("c3d8.inp"))
seen["C3D8 read and written"] = types("again.inp")[0]
print("meshio", meshio.__version__)
for cell, element in seen.items():
    print(f"{cell}: {element}")
described = {"tetra": "C3D4", "tetra10": "C3D10MH", "hexahedron": "C3D8RH", "triangle": "R3D3", "quad": "CAX4P",
             "C3D8 read and written": "C3D8RH"}
sys.exit(0 if seen == described else "this has changed")
END
