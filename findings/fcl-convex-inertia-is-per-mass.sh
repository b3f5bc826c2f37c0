#!/usr/bin/env bash
# FCL 0.7.0 (Debian 12: libfcl-dev 0.7.0-3+b1): the moment of inertia of a Convex.
#
# CollisionGeometry::computeMomentofInertia documents no mass; for all shapes and for meshes it is the inertia at
# density 1, with computeVolume as the mass.
# Expected: a cube as a Convex has the inertia of the same cube as a Box or a mesh.
# Seen: the Convex has that divided by its volume: an inertia per unit of mass.  A cube of 0.1 m is off by a factor
#   of 1000 (multiplied by the density as the others it spins a thousand times too slowly).
package=libfcl-dev version=0.7.0-3+b1
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
#include <fcl/fcl.h>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>
using Vector = fcl::Vector3<double>;

int main() {
  bool as_described = true;
  for (const double side : {0.1, 2.0}) {
    auto corners = std::make_shared<std::vector<Vector>>();
    for (int i = 0; i < 8; ++i) corners->push_back(side * Vector((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5));
    const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    auto faces = std::make_shared<std::vector<int>>();
    std::vector<fcl::Triangle> triangles;
    for (const auto& q : quads) {
      faces->insert(faces->end(), {4, q[0], q[1], q[2], q[3]});
      triangles.emplace_back(q[0], q[1], q[2]);
      triangles.emplace_back(q[0], q[2], q[3]);
    }
    const fcl::Convex<double> convex(corners, 6, faces);
    const fcl::Box<double> box(side, side, side);
    fcl::BVHModel<fcl::OBBRSS<double>> mesh;
    mesh.beginModel();
    mesh.addSubModel(*corners, triangles);
    mesh.endModel();
    const auto inertia = [](const fcl::CollisionGeometry<double>& g) { return g.computeMomentofInertia()(0, 0); };
    std::printf("cube of %g m: volume %g of all three; inertia as Box %.4g, mesh %.4g, Convex %.4g\n", side,
                convex.computeVolume(), inertia(box), inertia(mesh), inertia(convex));
    const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-9 * b; };
    as_described = as_described && same(convex.computeVolume(), box.computeVolume()) &&
                   same(inertia(mesh), inertia(box)) && same(inertia(convex) * convex.computeVolume(), inertia(box));
  }
  return as_described ? 0 : 1;
}
END
g++ -std=c++17 -I"$usr/include" -I"$usr/include/eigen3" -isystem /usr/include/eigen3 inertia.cpp -o inertia \
  -L"$lib" -lfcl -lccd -loctomap -loctomath ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib ./inertia || { echo "this has changed"; exit 1; }
