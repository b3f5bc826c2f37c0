#!/usr/bin/env bash
# DART 6.12.1 (Debian 12: libdart-dev 6.12.1+dfsg4-12+b2): spheres in its default collision detector.
#
# Expected: FCLCollisionDetector, the default of a World, hands a SphereShape to FCL as a sphere, which FCL has: one
#   contact with the depth of the overlap and the normal along the centres.
# Seen: it hands over a polyhedron with its corners on the sphere.  Two spheres of 1 m that overlap by 20 mm may not
#   touch at all; where they do, there are many contacts, with normals tens of degrees off the line of centres.
#   (setPrimitiveShapeType(PRIMITIVE) uses FCL's spheres, with a warning that advises against it.)
package=libdart-dev version=6.12.1+dfsg4-12+b2
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
cat >spheres.cpp <<'END'
#include <dart/collision/CollisionGroup.hpp>
#include <dart/collision/fcl/FCLCollisionDetector.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
using dart::collision::FCLCollisionDetector;
using dart::dynamics::Frame;
using dart::dynamics::SimpleFrame;

// The contacts of two unit spheres whose centres are 2 - overlap apart along the direction.
struct Seen {
  std::size_t contacts;
  double angle;  // greatest between a normal and the line of centres, degrees
};
Seen touch(FCLCollisionDetector::PrimitiveShape type, const Eigen::Vector3d& direction, double overlap) {
  const auto detector = FCLCollisionDetector::create();
  if (type != FCLCollisionDetector::MESH) detector->setPrimitiveShapeType(type);
  const auto sphere = std::make_shared<dart::dynamics::SphereShape>(1.0);
  const auto a = SimpleFrame::createShared(Frame::World()), b = SimpleFrame::createShared(Frame::World());
  a->setShape(sphere);
  b->setShape(sphere);
  b->setTranslation((2 - overlap) * direction.normalized());
  const auto first = detector->createCollisionGroup(a.get()), second = detector->createCollisionGroup(b.get());
  dart::collision::CollisionResult result;
  first->collide(second.get(), dart::collision::CollisionOption(true, 100), &result);
  Seen seen{result.getNumContacts(), 0};
  for (const auto& contact : result.getContacts()) {
    const double cosine = std::min(1.0, std::abs(contact.normal.dot(direction.normalized())));
    seen.angle = std::max(seen.angle, std::acos(cosine) * 180 / M_PI);
  }
  return seen;
}

int main() {
  const Eigen::Vector3d up(0, 0, 1), diagonal(1, 1, 1);
  const Seen missed = touch(FCLCollisionDetector::MESH, diagonal, 0.02);
  const Seen tilted = touch(FCLCollisionDetector::MESH, up, 0.1);
  const Seen sphere = touch(FCLCollisionDetector::PRIMITIVE, diagonal, 0.02);
  std::printf("by default, overlap 0.02 along the diagonal: %zu contacts\n", missed.contacts);
  std::printf("by default, overlap 0.1 upwards: %zu contacts, normals up to %.0f degrees off\n", tilted.contacts,
              tilted.angle);
  std::printf("as primitives, overlap 0.02 along the diagonal: %zu contact, normal %.0f degrees off\n", sphere.contacts,
              sphere.angle);
  return missed.contacts == 0 && tilted.contacts > 1 && tilted.angle > 10 && sphere.contacts == 1 ? 0 : 1;
}
END
g++ -std=c++17 -isystem "$usr/include" -isystem "$usr/include/eigen3" -isystem /usr/include/eigen3 \
  spheres.cpp -o spheres -L"$lib" -Wl,-rpath-link,"$lib:$lib/blas:$lib/lapack" \
  -ldart -lassimp -lfcl -lccd -loctomap -loctomath ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack ./spheres || { echo "this has changed"; exit 1; }
