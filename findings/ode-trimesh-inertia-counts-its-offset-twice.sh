#!/usr/bin/env bash
# ODE 0.16.2 (Debian 12: libode-dev 2:0.16.2-1): dMassSetTrimesh for a mesh that is not about its origin.
#
# dMass holds the centre of mass and the inertia about the origin; the setters of all other shapes have the centre
#   at the origin.
# Expected: for a box of 1 x 2 x 3 m as a mesh with its centre at (1, 2, 3), the inertia about the origin is that of
#   the box plus m (d^2 - d d^T), and dMassTranslate by minus the centre leaves the one of the box: 6.5, 5.0 and
#   2.5 kg m^2 at 1 kg/m^3.
# Seen: the term of the offset is added twice, so that the moved mass still has it once: 84.5, 65.0 and 32.5, and
#   products of inertia.  A mesh about its origin is right.  Meshes in a scanner's or a CAD program's axes turn as
#   if they were many times heavier.
package=libode-dev version=2:0.16.2-1
set -euo pipefail
skip() { echo "cannot run here: $*"; exit 77; }
command -v g++ >/dev/null || skip "g++ is missing"
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
usr=$folder/usr lib=$folder/usr/lib/$(uname -m)-linux-gnu
if [[ $(dpkg-query -W -f='${Version}' "$package" 2>/dev/null) != "$version" ]]; then
  apt-get -s --no-install-recommends install "$package=$version" >plan 2>/dev/null ||
    skip "apt has no $package $version"
  sed -nE 's/^Inst ([^ ]+) .*\(([^ ]+) .*/\1=\2/p' plan | xargs apt-get download >/dev/null 2>&1 || skip "no network"
  for archive in *.deb; do dpkg -x "$archive" .; done
fi
cat >inertia.cpp <<'END'
#include <ode/ode.h>
#include <cmath>
#include <cstdio>
#include <vector>

dMass mass_of_box_mesh(double x, double y, double z) {
  static std::vector<std::vector<double>> kept;  // ODE refers to the arrays
  static std::vector<dTriIndex> faces = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                         2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  std::vector<double> points;
  for (int i = 0; i < 8; ++i)
    points.insert(points.end(), {x + (i & 1 ? 0.5 : -0.5), y + (i & 2 ? 1.0 : -1.0), z + (i & 4 ? 1.5 : -1.5)});
  kept.push_back(points);
  dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(data, kept.back().data(), 3 * sizeof(double), 8, faces.data(), faces.size(),
                              3 * sizeof(dTriIndex));
  dMass mass;
  dMassSetTrimesh(&mass, 1.0, dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr));
  return mass;
}

bool is(const dMass& mass, double xx, double yy, double zz) {
  return std::abs(mass.I[0] - xx) < 1e-6 && std::abs(mass.I[5] - yy) < 1e-6 && std::abs(mass.I[10] - zz) < 1e-6;
}

void print(const char* what, const dMass& mass) {
  std::printf("%-28s mass %.3f  inertia %.2f %.2f %.2f  products %.1f %.1f %.1f\n", what, mass.mass, mass.I[0],
              mass.I[5], mass.I[10], mass.I[1], mass.I[2], mass.I[6]);
}

int main() {
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  dMass box, centred = mass_of_box_mesh(0, 0, 0), moved = mass_of_box_mesh(1, 2, 3);
  dMassSetBox(&box, 1.0, 1.0, 2.0, 3.0);
  dMassTranslate(&moved, -moved.c[0], -moved.c[1], -moved.c[2]);
  print("dMassSetBox", box);
  print("mesh about its origin", centred);
  print("mesh at (1, 2, 3), moved back", moved);
  const bool same = is(box, 6.5, 5.0, 2.5) && is(centred, 6.5, 5.0, 2.5) && is(moved, 84.5, 65.0, 32.5);
  if (!same) std::puts("this has changed");
  return same ? 0 : 1;
}
END
g++ -O1 -DdIDEDOUBLE -I"$usr/include" inertia.cpp -o inertia -L"$lib" -lode
LD_LIBRARY_PATH=$lib ./inertia
