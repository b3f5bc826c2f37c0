#!/usr/bin/env bash
# Bullet 3.24 (Debian 12: libbullet-dev 3.24+dfsg-2): the Young's modulus of btDeformableNeoHookeanForce.
#
# Expected: with setLameParameters(mu, lambda), or setYoungsModulus and setPoissonRatio, which compute these, a
#   small shear strain e has the stress 2 mu e and a small dilation the pressure 3 (lambda + 2/3 mu) e, as with
#   btDeformableLinearElasticityForce.
# Seen: the shear stress is 3/4 of that (and the pressure 0.64 of it for a Poisson's ratio of 0.3): the energy has
#   another mu and lambda than Lame's, and nothing converts them.  A body of 1000 Pa behaves as one of 733 Pa.
package=libbullet-dev version=3.24+dfsg-2
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
cat >stress.cpp <<'END'
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <cmath>
#include <cstdio>

// The first Piola stress of one tetrahedron of volume 1/6 at the deformation gradient, from its nodes' forces.
template <class Force>
btMatrix3x3 stress(const btMatrix3x3& gradient) {
  btSoftBodyWorldInfo world;
  const btVector3 rest[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  btSoftBody body(&world, 4, rest, nullptr);
  for (int i = 0; i < 4; ++i) {
    body.m_nodes[i].index = i;
    body.m_nodes[i].m_q = rest[i];
  }
  body.appendTetra(0, 1, 2, 3);
  body.m_tetraScratches.resize(1);
  body.m_tetraScratchesTn.resize(1);
  body.initializeDmInverse();
  for (int i = 0; i < 4; ++i) body.m_nodes[i].m_x = body.m_nodes[i].m_q = gradient * rest[i];
  body.updateDeformation();
  Force force;
  force.setDamping(0, 0);
  force.setYoungsModulus(1000);
  force.setPoissonRatio(0.3);
  force.addSoftBody(&body);
  btAlignedObjectArray<btVector3> forces;
  forces.resize(4, btVector3(0, 0, 0));
  force.addScaledElasticForce(1, forces);
  btMatrix3x3 p;
  for (int row = 0; row < 3; ++row) p[row].setValue(-6 * forces[1][row], -6 * forces[2][row], -6 * forces[3][row]);
  return p;
}
struct NeoHookean : btDeformableNeoHookeanForce {
  void setDamping(btScalar d, btScalar) { btDeformableNeoHookeanForce::setDamping(d); }
};

int main() {
  const btScalar e = 1e-3f;
  const btMatrix3x3 shear(1, e, 0, e, 1, 0, 0, 0, 1), dilation(1 + e, 0, 0, 0, 1 + e, 0, 0, 0, 1 + e);
  const double mu = 1000 / 2.6, bulk = 1000 / (3 * 0.4);
  const double expected[2] = {2 * mu * e, 3 * bulk * e};
  const double linear[2] = {stress<btDeformableLinearElasticityForce>(shear)[0][1],
                            stress<btDeformableLinearElasticityForce>(dilation)[0][0]};
  const double neo[2] = {stress<NeoHookean>(shear)[0][1], stress<NeoHookean>(dilation)[0][0]};
  std::printf("stress of a shear of 1e-3:    expected %.4f, linear %.4f, neo-Hookean %.4f Pa\n", expected[0], linear[0],
              neo[0]);
  std::printf("stress of a dilation of 1e-3: expected %.4f, linear %.4f, neo-Hookean %.4f Pa\n", expected[1], linear[1],
              neo[1]);
  const double g = neo[0] / (2 * e), k = neo[1] / (3 * e);
  std::printf("Young's modulus: asked for 1000, neo-Hookean has %.0f Pa\n", 9 * k * g / (3 * k + g));
  const auto near = [](double a, double b) { return std::abs(a / b - 1) < 0.005; };
  const bool right = near(linear[0], expected[0]) && near(linear[1], expected[1]);
  return right && near(neo[0], 0.75 * expected[0]) && near(neo[1], 0.6366 * expected[1]) ? 0 : 1;
}
END
g++ -std=c++17 -isystem "$usr/include/bullet" -isystem /usr/include/bullet stress.cpp -o stress -L"$lib" \
  -lBulletSoftBody -lBulletDynamics -lBulletCollision -lLinearMath ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib ./stress || { echo "this has changed"; exit 1; }
