#!/usr/bin/env bash
# Simbody 3.7 (Debian 12: libsimbody-dev 3.7+dfsg-3): memory in calls on one free rigid body.
#
# Expected: once the State is realised and the outputs have their size, calcM() and
#   calcResidualForceIgnoringConstraints() take no memory: no size ever changes.  A servo loop must not allocate,
#   since malloc has no bound in time.
# Seen: calcM() allocates 22 times and calcResidualForceIgnoringConstraints() 10 times, in each call; realize() does
#   not.
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
cat >servo.cpp <<'END'
#include <Simbody.h>
#include <cstdio>
#include <cstdlib>
#include <new>
using namespace SimTK;

static long allocations = 0;
void* operator new(std::size_t n) {
  ++allocations;
  if (void* p = std::malloc(n ? n : 1)) return p;
  throw std::bad_alloc();
}
void* operator new[](std::size_t n) { return operator new(n); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }

int main() {
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  Body::Rigid body(MassProperties(1.0, Vec3(0), UnitInertia::sphere(0.1)));
  MobilizedBody::Free tool(matter.Ground(), Transform(), body, Transform());
  State state = system.realizeTopology();
  Matrix M;
  Vector u_dot(6, Real(0)), residual, forces(6, Real(0));
  Vector_<SpatialVec> body_forces(matter.getNumBodies(), SpatialVec(Vec3(0)));
  long realise = 0, mass = 0, inverse = 0;
  for (int i = 0; i < 1000; ++i) {
    state.updU()[0] = 0.001 * i;
    long before = allocations;
    system.realize(state, Stage::Velocity);
    realise = allocations - before;
    before = allocations;
    matter.calcM(state, M);
    mass = allocations - before;
    before = allocations;
    matter.calcResidualForceIgnoringConstraints(state, forces, body_forces, u_dot, residual);
    inverse = allocations - before;
  }
  std::printf("allocations in the 1,000th call: realize %ld, calcM %ld, "
              "calcResidualForceIgnoringConstraints %ld\n", realise, mass, inverse);
  const bool same = mass + inverse >= 20;
  if (!same) std::puts("this has changed");
  return same ? 0 : 1;
}
END
g++ -O1 -w -std=c++17 -I"$usr/include/simbody" servo.cpp -o servo -L"$lib" -lSimTKsimbody -lSimTKmath -lSimTKcommon
LD_LIBRARY_PATH=$lib:$lib/openblas-pthread:$lib/lapack:$lib/blas ./servo
