#!/usr/bin/env bash
# FCL 0.7.0 (Debian 12: libfcl-dev 0.7.0-3+b1): the normal of collide(shape, mesh).
#
# contact.h: the normal points from o1 to o2.
# Expected: o1 of each contact is the first object of the call, and the normal turns round when the two are
#   exchanged, as it does for two shapes and for two meshes.
# Seen: of a shape and a mesh, o1 is the mesh whichever was given first: the normal of collide(box, mesh) points
#   from the second to the first.  A force along it pulls instead of pushing for this one kind of pair.
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
cat >normal.cpp <<'END'
#include <fcl/fcl.h>
#include <array>
#include <cstdio>
#include <vector>
using Vector = fcl::Vector3<double>;
using Geometry = fcl::CollisionGeometry<double>;

// Whether the first contact's normal points from the first to the second, which lies above or below it.
bool leaves_first(const char* name, const Geometry& first, const Geometry& second) {
  bool leaves = true;
  for (const double height : {1.9, -1.9}) {
    auto pose = fcl::Transform3<double>::Identity();
    pose.translation() = Vector(0.3, 0.2, height);
    const fcl::CollisionRequest<double> request(100, true);
    fcl::CollisionResult<double> result;
    fcl::collide<double>(&first, fcl::Transform3<double>::Identity(), &second, pose, request, result);
    const auto& contact = result.getContact(0);
    leaves = leaves && contact.normal.z() * height > 0;
    std::printf("%s, the second %s: normal (%.2f, %.2f, %.2f), o1 is the %s\n", name, height > 0 ? "above" : "below",
                contact.normal.x(), contact.normal.y(), contact.normal.z(), contact.o1 == &first ? "first" : "second");
  }
  return leaves;
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
  const bool others = leaves_first("box, sphere", box, sphere) && leaves_first("sphere, box", sphere, box) &&
                      leaves_first("mesh, box", mesh, box);
  return others && !leaves_first("box, mesh", box, mesh) ? 0 : 1;
}
END
g++ -std=c++17 -I"$usr/include" -I"$usr/include/eigen3" -isystem /usr/include/eigen3 normal.cpp -o normal \
  -L"$lib" -lfcl -lccd -loctomap -loctomath ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib ./normal || { echo "this has changed"; exit 1; }
