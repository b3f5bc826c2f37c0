#!/usr/bin/env bash
# FCL 0.7.0 (Debian 12: libfcl-dev 0.7.0-3+b1): the sign of the penetration depth of a mesh and a sphere.
#
# Expected: Contact::penetration_depth of two solids that overlap is positive, as it is for two spheres, a box and
#   a sphere, a mesh and a box, and two meshes, all with the solver by default.
# Seen: for a mesh and a sphere it is negative, as a signed distance would be.  A penalty force from it pulls the
#   sphere in; the deepest contact of several, taken by the maximum, is the shallowest.
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
cat >depth.cpp <<'END'
#include <fcl/fcl.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>
using Vector = fcl::Vector3<double>;
using Geometry = fcl::CollisionGeometry<double>;

// The extreme depths of the contacts of a and b, with b's centre at height z above a's.
struct Depths {
  double least = 1e300, greatest = -1e300;
};
Depths depths(const char* name, const Geometry& a, const Geometry& b) {
  auto above = fcl::Transform3<double>::Identity();
  above.translation() = Vector(0.3, 0.2, 1.9);
  const fcl::CollisionRequest<double> request(100, true);
  fcl::CollisionResult<double> result;
  fcl::collide<double>(&a, fcl::Transform3<double>::Identity(), &b, above, request, result);
  Depths d;
  for (std::size_t i = 0; i < result.numContacts(); ++i) {
    d.least = std::min(d.least, result.getContact(i).penetration_depth);
    d.greatest = std::max(d.greatest, result.getContact(i).penetration_depth);
  }
  std::printf("%s, overlapping by 0.1: %zu contacts, depth %.3f to %.3f\n", name, result.numContacts(), d.least,
              d.greatest);
  return d;
}

int main() {
  std::vector<Vector> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back((i & 1) * 2 - 1, (i & 2) - 1, (i & 4) / 2 - 1);
  std::vector<fcl::Triangle> triangles;
  for (const auto& q : {std::array{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    triangles.emplace_back(q[0], q[1], q[2]);
    triangles.emplace_back(q[0], q[2], q[3]);
  }
  fcl::BVHModel<fcl::OBBRSS<double>> mesh;
  mesh.beginModel();
  mesh.addSubModel(corners, triangles);
  mesh.endModel();
  const fcl::Box<double> box(2, 2, 2);
  const fcl::Sphere<double> sphere(1);
  const bool others = depths("box and sphere", box, sphere).least > 0 && depths("mesh and box", mesh, box).least > 0 &&
                      depths("mesh and mesh", mesh, mesh).least > 0;
  return others && depths("mesh and sphere", mesh, sphere).greatest < 0 ? 0 : 1;
}
END
g++ -std=c++17 -I"$usr/include" -I"$usr/include/eigen3" -isystem /usr/include/eigen3 depth.cpp -o depth \
  -L"$lib" -lfcl -lccd -loctomap -loctomath ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib ./depth || { echo "this has changed"; exit 1; }
