#!/usr/bin/env bash
# SciPy 1.10.1 (Debian 12: python3-scipy 1.10.1-2): scipy.spatial.Delaunay of a regular grid of points in space.
#
# Expected: its simplices are a tetrahedral mesh: each has a volume.  Points of a grid lie on common spheres, so
#   that the mesh is not unique, but any of them fills the cube with tetrahedra.
# Seen: 166 of the 916 tetrahedra between 6 x 6 x 6 points are flat (four corners of a square): volume zero,
#   no inverse of the edge matrix, infinite gradients.  Their neighbours are right, so that they cannot just be
#   left out: that opens the mesh between two diagonals of a square.
package=python3-scipy version=1.10.1-2
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
import sys
import numpy
from collections import Counter
from scipy.spatial import Delaunay

grid = numpy.stack(numpy.meshgrid(*[numpy.arange(6.0)] * 3, indexing="ij"), -1).reshape(-1, 3)
tetrahedra = Delaunay(grid).simplices
corners = grid[tetrahedra]
volumes = abs(numpy.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
flat = volumes < 1e-9
def unmatched(cells):
    "Faces of one cell only that do not lie in the cube's surface."
    faces = Counter(tuple(sorted(numpy.delete(cell, k))) for cell in cells for k in range(4))
    single = numpy.array([face for face, count in faces.items() if count == 1])
    points = grid[single]
    outside = [numpy.all(points[:, :, axis] == side, axis=1) for axis in range(3) for side in (0, 5)]
    return int(numpy.sum(~numpy.any(outside, axis=0)))
seen = len(tetrahedra), int(flat.sum()), unmatched(tetrahedra), unmatched(tetrahedra[~flat])
print("tetrahedra %d, flat %d; volume in all %.6f, of the cube 125" % (seen[0], seen[1], volumes.sum()))
print("inner faces without a neighbour: %d; without the flat tetrahedra: %d" % seen[2:])
sys.exit(0 if seen[1] > 0.1 * seen[0] and seen[2] == 0 and seen[3] > 0 else "this has changed")
END
