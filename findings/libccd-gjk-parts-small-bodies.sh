#!/usr/bin/env bash
# libccd 2.1 (Debian 12: libccd-dev 2.1-2+b1): ccdGJKIntersect and small bodies.
#
# Expected: whether two convex bodies overlap does not depend on the unit of length: spheres of 1 mm that overlap by
#   0.4 mm intersect, in metres as in millimetres.
# Seen: of 1000 pairs of spheres with a radius of 1, all intersect; of the same pairs with a radius of 0.001, none;
#   of the cubes with that half edge, about a half.  GJK compares squared distances and coordinates with an absolute
#   epsilon.  ccdMPRIntersect finds all pairs at all sizes.  A simulator in SI units lets small tools pass through.
package=libccd-dev version=2.1-2+b1
set -euo pipefail
skip() { echo "cannot run here: $*"; exit 77; }
command -v gcc >/dev/null || skip "gcc is missing"
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
cat >sizes.c <<'END'
#include <ccd/ccd.h>
#include <ccd/quat.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct body { double centre[3], size; };

static void sphere(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const struct body* b = object;
  const double length = sqrt(ccdVec3Len2(direction));
  for (int i = 0; i < 3; ++i) out->v[i] = b->centre[i] + b->size * direction->v[i] / length;
}
static void cube(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const struct body* b = object;
  for (int i = 0; i < 3; ++i) out->v[i] = b->centre[i] + (direction->v[i] > 0 ? b->size : -b->size);
}
static void centre(const void* object, ccd_vec3_t* out) {
  for (int i = 0; i < 3; ++i) out->v[i] = ((const struct body*)object)->centre[i];
}

/* Pairs found, of 1000 whose centres are 1.6 sizes apart in any direction. */
static int found(ccd_support_fn support, double size, int (*intersect)(const void*, const void*, const ccd_t*)) {
  int count = 0;
  srand(1);
  for (int k = 0; k < 1000; ++k) {
    struct body a = {{0, 0, 0}, size}, b = {{0, 0, 0}, size};
    double length = 0;
    for (int i = 0; i < 3; ++i) b.centre[i] = rand() / (double)RAND_MAX - 0.5, length += b.centre[i] * b.centre[i];
    for (int i = 0; i < 3; ++i) b.centre[i] *= 1.6 * size / sqrt(length);
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = support;
    ccd.center1 = ccd.center2 = centre;
    ccd.max_iterations = 1000;
    count += intersect(&a, &b, &ccd);
  }
  return count;
}

int main(void) {
  const double sizes[] = {1, 0.01, 0.001};
  int gjk[3][2], mpr[3][2];
  for (int s = 0; s < 3; ++s) {
    gjk[s][0] = found(sphere, sizes[s], ccdGJKIntersect), gjk[s][1] = found(cube, sizes[s], ccdGJKIntersect);
    mpr[s][0] = found(sphere, sizes[s], ccdMPRIntersect), mpr[s][1] = found(cube, sizes[s], ccdMPRIntersect);
    printf("size %-5g  of 1000 overlapping pairs GJK finds %4d of spheres, %4d of cubes; MPR %4d, %4d\n",
           sizes[s], gjk[s][0], gjk[s][1], mpr[s][0], mpr[s][1]);
  }
  const int same = gjk[0][0] == 1000 && gjk[0][1] == 1000 && gjk[2][0] < 10 && gjk[2][1] < 700 &&
                   mpr[2][0] == 1000 && mpr[2][1] == 1000;
  if (!same) puts("this has changed");
  return !same;
}
END
gcc -O1 -w ${usr:+-I"$usr/include"} sizes.c -o sizes -L"$lib" -lccd -lm
LD_LIBRARY_PATH=$lib ./sizes
