#!/usr/bin/env bash
# DART 6.12.1 (Debian 12: libdart-dev 6.12.1+dfsg4-12+b2): volume and inertia of a MeshShape.
#
# Expected: getVolume and computeInertia of a closed mesh are those of the solid, as they are for spheres, cylinders
#   and capsules.
# Seen: they are those of the mesh's bounding box.  A tetrahedron has six times its volume, and 2.2 times its inertia
#   at the same mass: a tool whose mass comes from a density is six times too heavy.
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
cat >inertia.cpp <<'END'
#include <assimp/scene.h>
#include <dart/dynamics/MeshShape.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <cmath>
#include <cstdio>

int main() {
  auto* scene = new aiScene;
  scene->mMeshes = new aiMesh*[scene->mNumMeshes = 1];
  auto* mesh = scene->mMeshes[0] = new aiMesh;
  mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  mesh->mVertices = new aiVector3D[mesh->mNumVertices = 4]{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh->mFaces = new aiFace[mesh->mNumFaces = 4];
  const unsigned faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (int i = 0; i < 4; ++i)
    mesh->mFaces[i].mIndices = new unsigned[mesh->mFaces[i].mNumIndices = 3]{faces[i][0], faces[i][1], faces[i][2]};
  const dart::dynamics::MeshShape tetrahedron(Eigen::Vector3d::Ones(), scene);
  const double volume = tetrahedron.getVolume(), inertia = tetrahedron.computeInertia(1.0)(0, 0);
  const double ball = dart::dynamics::SphereShape(1.0).getVolume();
  std::printf("a tetrahedron of edges 1: volume %.4f, expected %.4f; inertia of 1 kg %.4f, expected %.4f\n", volume,
              1.0 / 6, inertia, 0.075);
  std::printf("a sphere of radius 1: volume %.4f, expected %.4f\n", ball, 4 * M_PI / 3);
  const auto near = [](double a, double b) { return std::abs(a - b) < 1e-6; };
  return near(volume, 1) && near(inertia, 1.0 / 6) && near(ball, 4 * M_PI / 3) ? 0 : 1;
}
END
g++ -std=c++17 -isystem "$usr/include" -isystem "$usr/include/eigen3" -isystem /usr/include/eigen3 \
  inertia.cpp -o inertia -L"$lib" -Wl,-rpath-link,"$lib:$lib/blas:$lib/lapack" -ldart -lassimp ||
  skip "it does not compile"
LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack ./inertia || { echo "this has changed"; exit 1; }
