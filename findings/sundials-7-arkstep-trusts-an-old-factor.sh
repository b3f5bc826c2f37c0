#!/usr/bin/env bash
# SUNDIALS 7.1.1 (Debian 13: libsundials-dev 7.1.1+dfsg1-10): where a stop time shortens the last step of ARKStep
# by less than a fifth, the state is off by up to a million times the tolerance, as a success.
#
# Expected: ARKStepSetStopTime(T) and ARKStepEvolve to T give y(T) as ARKStepEvolve to T without it does, within
#   some multiples of the tolerance; ARKodeSetDeltaGammaMax trades factorisations for iterations, not accuracy.
# Seen: y' = -y by the default implicit method at rtol 1e-10, to 157 times between 0.3 and 3.0: without a stop
#   time all errors are below 1e-10; with it 26 are above 1e-8, up to 3.5e-4; with it and a new factor for each
#   size of step (ARKodeSetDeltaGammaMax 1e-15) none.  The flag is ARK_TSTOP_RETURN, and no step failed its error
#   test.  What happens: on a linear problem every solve with a fresh factor converges at once, and the estimated
#   rate of convergence falls to nothing; it is kept with the factor, and the first correction of a step of
#   another size, wrong by its relative difference, passes the test.  The default table is stiffly accurate, and
#   since 7 its last stage is the new state as Newton left it.
# In palpate: its own test of convergence (Adapter::test_convergence, src/integrate/sundials/adapter.cpp) bounds
#   the rate from below by the age of the factor; StiffEquations.LinearDecayToAnyStopTime.  The self test in
#   src/integrate/sundials/self_test.cpp, which has the bare library, sets no stop time.
#
#   sundials-7-arkstep-trusts-an-old-factor.sh [ROOT]
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
cat >"$root$work/stop.c" <<'END'
#include <arkode/arkode_arkstep.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

static int decay(sunrealtype t, N_Vector y, N_Vector rate, void* data) {
  NV_Ith_S(rate, 0) = -NV_Ith_S(y, 0);
  return 0;
}
int main(void) {
  for (int kind = 0; kind < 3; ++kind) {
    const char* name[] = {"without a stop time", "with a stop time", "with a stop time and new factors"};
    double worst = 0.0;
    int all = 0, far = 0;
    for (double end = 0.3; end < 3.0; end += 0.0173) {
      SUNContext context;
      SUNContext_Create(SUN_COMM_NULL, &context);
      N_Vector y = N_VNew_Serial(1, context);
      NV_Ith_S(y, 0) = 1.0;
      SUNMatrix A = SUNDenseMatrix(1, 1, context);
      SUNLinearSolver solver = SUNLinSol_Dense(y, A, context);
      void* memory = ARKStepCreate(NULL, decay, 0.0, y, context);
      ARKodeSStolerances(memory, 1e-10, 1e-12);
      ARKodeSetLinearSolver(memory, solver, A);
      if (kind > 0) ARKodeSetStopTime(memory, end);
      if (kind > 1) ARKodeSetDeltaGammaMax(memory, 1e-15);
      sunrealtype t;
      if (ARKodeEvolve(memory, end, y, &t, ARK_NORMAL) < 0) return 1;
      const double error = fabs(NV_Ith_S(y, 0) - exp(-end));
      ++all;
      far += error > 1e-8;
      if (error > worst) worst = error;
    }
    printf("%s: %d of %d errors above 1e-8, the largest %.1e\n", name[kind], far, all, worst);
  }
  return 0;
}
END
inside() { chroot "$root" sh -c "cd $work && $1"; }
inside 'gcc stop.c -o stop $(pkg-config --cflags ompi-c 2>/dev/null ||
  echo -I/usr/lib/$(gcc -dumpmachine)/openmpi/include) \
  -lsundials_arkode -lsundials_nvecserial -lsundials_sunlinsoldense -lsundials_sunmatrixdense \
  -lsundials_core -lmpi -lm'
seen=$(inside './stop 2>/dev/null')
rm -rf -- "$root$work"
echo "$seen"
for line in 'without a stop time: 0 of 157 ' 'with a stop time: 26 of 157 .*3\.5e-04$' \
  'with a stop time and new factors: 0 of 157 '; do
  grep -q "^$line" <<<"$seen" || { echo "changed"; exit 1; }
done
echo "as described: the shortened last step is off by a million times the tolerance, but with new factors"
