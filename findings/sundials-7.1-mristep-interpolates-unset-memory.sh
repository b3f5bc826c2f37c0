#!/usr/bin/env bash
# SUNDIALS 7.1.1 (Debian 13: libsundials-dev 7.1.1+dfsg1-10): within the first step of MRIStep with a method of
# order 4, dense output interpolates with a right-hand side that was never evaluated: it depends on what the
# memory held.
#
# Expected: after each step ARKodeGetDky gives y between its ends by a cubic Hermite interpolant, about as exact
#   as the step; roots are found on it, too.
# Seen: y' = -y, half of it slow and half fast, ten fixed steps of 0.1: the ends of the steps are right to 1e-5.
#   In the middle of the first one y is off by 1.2e-2 with fresh memory filled with zeros (MALLOC_PERTURB_ of
#   glibc), by more than 1e50 with another byte, both with ARK_SUCCESS; later ones are right here only because
#   GetDky itself evaluates both sides at the end of each step.  What happens: a step evaluates the slow side at
#   its start, and marks the memory of the whole right-hand side, which nobody has written, as current.  Mended
#   in 7.2.0 ("did not include contributions from the fast right-hand side").
# In palpate: evaluate_start in src/integrate/sundials/release.h; Steppers.InterpolateWithinLaterSteps.
#
#   sundials-7.1-mristep-interpolates-unset-memory.sh [ROOT]
#
# ROOT is a Debian 13 that has gcc and libsundials-dev; default: one by debootstrap, in a temporary folder
# (needs root and the network).
set -euo pipefail
version=7.1.1+dfsg1-10
skip() { echo "cannot run here: $*"; exit 77; }
((EUID == 0)) || skip "it needs root, for chroot"
root=${1-}
if [[ -z $root ]]; then
  command -v debootstrap >/dev/null || skip "debootstrap is missing"
  root=$(mktemp -d)
  trap 'rm -rf -- "$root"' EXIT
  debootstrap --variant=minbase trixie "$root" >/dev/null
  chroot "$root" sh -c "apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install --yes \
    --no-install-recommends gcc libc6-dev libsundials-dev=$version" >/dev/null
fi
have=$(chroot "$root" dpkg-query -W -f='${Version}' libsundials-dev)
[[ $have == "$version" ]] || skip "libsundials-dev is $have, not $version"

work=$(chroot "$root" mktemp -d)
cat >"$root$work/middle.c" <<'END'
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_mristep.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>

static int half(sunrealtype t, N_Vector y, N_Vector rate, void* data) {
  NV_Ith_S(rate, 0) = -0.5 * NV_Ith_S(y, 0);
  return 0;
}
int main(void) {
  SUNContext context;
  SUNContext_Create(SUN_COMM_NULL, &context);
  N_Vector y = N_VNew_Serial(1, context), middle = N_VNew_Serial(1, context);
  NV_Ith_S(y, 0) = 1.0;
  void* fast = ARKStepCreate(half, NULL, 0.0, y, context);
  ARKodeSStolerances(fast, 1e-10, 1e-12);
  MRIStepInnerStepper inner;
  ARKStepCreateMRIStepInnerStepper(fast, &inner);
  void* slow = MRIStepCreate(half, NULL, 0.0, y, inner, context);
  ARKodeSetFixedStep(slow, 0.1);
  ARKodeSetOrder(slow, 4);
  double at_ends = 0.0, in_middles = 0.0;
  int failed = 0;
  for (int i = 1; i <= 10; ++i) {
    sunrealtype t;
    failed += ARKodeEvolve(slow, 0.1 * i, y, &t, ARK_ONE_STEP) < 0;
    failed += ARKodeGetDky(slow, t - 0.05, 0, middle) != ARK_SUCCESS;
    at_ends = fmax(at_ends, fabs(NV_Ith_S(y, 0) - exp(-t)));
    in_middles = fmax(in_middles, fabs(NV_Ith_S(middle, 0) - exp(-(t - 0.05))));
  }
  printf("%d calls failed; errors at the steps' ends %s, in their middles %s\n", failed,
         at_ends < 1e-5 ? "below 1e-5" : "above 1e-5",
         in_middles < 1e-4 ? "below 1e-4" : in_middles > 1e50 ? "above 1e50" : "above 1e-4");
  return 0;
}
END
inside() { chroot "$root" sh -c "cd $work && $1"; }
inside 'gcc middle.c -o middle $(pkg-config --cflags ompi-c 2>/dev/null ||
  echo -I/usr/lib/$(gcc -dumpmachine)/openmpi/include) \
  -lsundials_arkode -lsundials_nvecserial -lsundials_core -lmpi -lm'
filled=$(inside 'MALLOC_PERTURB_=170 ./middle 2>/dev/null | grep calls')
zeros=$(inside 'MALLOC_PERTURB_=255 ./middle 2>/dev/null | grep calls')
rm -rf -- "$root$work"
echo "memory filled with one byte: $filled"
echo "with zeros:                  $zeros"
[[ $filled == "0 calls failed; errors at the steps' ends below 1e-5, in their middles above 1e50" &&
  $zeros == "0 calls failed; errors at the steps' ends below 1e-5, in their middles above 1e-4" ]] ||
  { echo "changed"; exit 1; }
echo "as described: dense output depends on what fresh memory holds"
