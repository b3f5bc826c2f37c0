#!/usr/bin/env bash
# FCL 0.7.0 (Debian 12: libfcl-dev 0.7.0-3+b1): the penetration depth of two meshes.
#
# Expected: where two meshed boxes overlap by 0.1 m, the depths of their contacts are at most 0.1 m (box and box,
#   and mesh and box, give 0.1 m for each contact).
# Seen: a contact of two meshes is one of two triangles, and its depth is how far one of them reaches beyond the
#   other's plane: up to 1.7 m here, with a normal that lies in the touched face.  The greatest depth, or the sum
#   of forces over the contacts, is that of other bodies.
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
#include <array>
#include <cstdio>
#include <vector>
using Vector = fcl::Vector3<double>;

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
  auto above = fcl::Transform3<double>::Identity();
  above.translation() = Vector(0.3, 0.2, 1.9);
  const fcl::CollisionRequest<double> request(100, true);
  double greatest[3] = {};
  const fcl::CollisionGeometry<double>* pairs[3][2] = {{&box, &box}, {&mesh, &box}, {&mesh, &mesh}};
  const char* names[3] = {"box and box", "mesh and box", "mesh and mesh"};
  for (int k = 0; k < 3; ++k) {
    fcl::CollisionResult<double> result;
    fcl::collide<double>(pairs[k][0], fcl::Transform3<double>::Identity(), pairs[k][1], above, request, result);
    Vector normal = Vector::Zero();
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const auto& contact = result.getContact(i);
      if (contact.penetration_depth <= greatest[k]) continue;
      greatest[k] = contact.penetration_depth;
      normal = contact.normal;
    }
    std::printf("%s, overlapping by 0.1: %zu contacts, greatest depth %.3f along (%.1f, %.1f, %.1f)\n", names[k],
                result.numContacts(), greatest[k], normal.x(), normal.y(), normal.z());
  }
  return greatest[0] < 0.101 && greatest[1] < 0.101 && greatest[2] > 1.6 ? 0 : 1;
}
END
g++ -std=c++17 -I"$usr/include" -I"$usr/include/eigen3" -isystem /usr/include/eigen3 depth.cpp -o depth \
  -L"$lib" -lfcl -lccd -loctomap -loctomath ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib ./depth || { echo "this has changed"; exit 1; }
