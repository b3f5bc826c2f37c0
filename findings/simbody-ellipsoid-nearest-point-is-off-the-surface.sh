#!/usr/bin/env bash
# Simbody 3.7 (Debian 12: libsimbody-dev 3.7+dfsg-3): ContactGeometry::Ellipsoid::findNearestPoint on an axis.
#
# Expected: the point returned lies on the ellipsoid, wherever the query is.  For semi-axes of 1, 2, 3 and a query
#   inside at (0, 0, 1) two points are nearest, (+-0.927, 0, 1.125) at a distance of 0.935: either will do.
# Seen: (0, 0, 1.125) at a distance of 0.125, inside the body; the centre is its own nearest point.  Beside the axis it
#   is worse: for (1e-9, 0, 1), a point of a distance of 6, outside.  From 1e-3 on the answers are right, and outside
#   the body on all axes.  Depths of a tool that comes in along an axis of symmetry, the usual test, are those of
#   another body.
package=libsimbody-dev version=3.7+dfsg-3
set -euo pipefail
skip() { echo "cannot run here: $*"; exit 77; }
command -v g++ >/dev/null || skip "g++ is missing"
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
usr=$folder/usr lib=$folder/usr/lib/$(uname -m)-linux-gnu
if [[ $(dpkg-query -W -f='${Version}' "$package" 2>/dev/null) == "$version" ]]; then
  usr=/usr lib=/usr/lib/$(uname -m)-linux-gnu
else
  apt-get -s --no-install-recommends install "$package=$version" >plan 2>/dev/null ||
    skip "apt has no $package $version"
  sed -nE 's/^Inst ([^ ]+) .*\(([^ ]+) .*/\1=\2/p' plan | xargs apt-get download >/dev/null 2>&1 || skip "no network"
  for archive in *.deb; do dpkg -x "$archive" .; done
fi
cat >nearest.cpp <<'END'
#include <simmath/internal/ContactGeometry.h>
#include <cmath>
#include <cstdio>
using SimTK::Vec3;

struct Answer { Vec3 point; double distance, surface; };

Answer nearest(const Vec3& query) {
  SimTK::ContactGeometry::Ellipsoid ellipsoid(Vec3(1, 2, 3));
  bool inside = false;
  SimTK::UnitVec3 normal;
  const Vec3 p = ellipsoid.findNearestPoint(query, inside, normal);
  const double surface = p[0] * p[0] + p[1] * p[1] / 4 + p[2] * p[2] / 9;
  std::printf("(%5g, %g, %g)  point (%.3f, %.3f, %.3f)  distance %.3f  x^2/a^2 + y^2/b^2 + z^2/c^2 = %.3f\n",
              query[0], query[1], query[2], p[0], p[1], p[2], (p - query).norm(), surface);
  return {p, (p - query).norm(), surface};
}

int main() {
  const Answer on = nearest(Vec3(0, 0, 1)), centre = nearest(Vec3(0, 0, 0)), near = nearest(Vec3(1e-9, 0, 1)),
               beside = nearest(Vec3(1e-3, 0, 1)), outside = nearest(Vec3(0, 0, 4));
  const bool same = std::abs(on.distance - 0.125) < 1e-6 && on.surface < 0.2 && centre.surface < 1e-6 &&
                    near.surface > 2 && std::abs(beside.surface - 1) < 1e-6 &&
                    std::abs(beside.distance - 0.934) < 1e-3 && std::abs(outside.surface - 1) < 1e-9;
  if (!same) std::puts("this has changed");
  return same ? 0 : 1;
}
END
g++ -O1 -w -std=c++17 -I"$usr/include/simbody" nearest.cpp -o nearest -L"$lib" -lSimTKmath -lSimTKcommon
LD_LIBRARY_PATH=$lib:$lib/openblas-pthread:$lib/lapack:$lib/blas ./nearest
