#!/usr/bin/env bash
# SUNDIALS 7.1.1 (Debian 13: libsundials-dev 7.1.1+dfsg1-10): an error handler that is pushed does not replace
# the one before it.
#
# Expected: SUNContext_PushErrHandler puts a handler on a stack, whose top handles errors; that of SUNDIALS,
#   which prints to standard error, is beneath it and silent.  (The CVodeSetErrHandlerFn of 6.4 replaced it.)
# Seen: each handler of the stack is called, from the top down.  An error is handled and printed.  Only after
#   SUNContext_ClearErrHandlers does the pushed one stand alone.
# In palpate: Context::prepare in src/integrate/sundials/release.h.
#
#   sundials-7-error-handlers-add-up.sh [ROOT]
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
cat >"$root$work/handlers.c" <<'END'
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>

static void handle(int line, const char* function, const char* file, const char* text, SUNErrCode code,
                   void* data, SUNContext context) {
  printf("handler: %s\n", text);
}
static int decay(sunrealtype t, N_Vector y, N_Vector rate, void* data) {
  NV_Ith_S(rate, 0) = -NV_Ith_S(y, 0);
  return 0;
}
int main(int count, char** arguments) {
  SUNContext context;
  SUNContext_Create(SUN_COMM_NULL, &context);
  if (count > 1) SUNContext_ClearErrHandlers(context);
  SUNContext_PushErrHandler(context, handle, NULL);
  N_Vector y = N_VNew_Serial(1, context);
  NV_Ith_S(y, 0) = 1.0;
  void* memory = CVodeCreate(CV_ADAMS, context);
  CVodeInit(memory, decay, 0.0, y);
  sunrealtype t;
  CVode(memory, 1.0, y, &t, CV_NORMAL); /* no tolerances were set: an error */
  return 0;
}
END
inside() { chroot "$root" sh -c "cd $work && $1"; }
inside 'gcc handlers.c -o handlers $(pkg-config --cflags ompi-c 2>/dev/null ||
  echo -I/usr/lib/$(gcc -dumpmachine)/openmpi/include) \
  -lsundials_cvode -lsundials_nvecserial -lsundials_core -lmpi'
inside './handlers >pushed.out 2>pushed.err; ./handlers cleared >cleared.out 2>cleared.err'
for run in pushed cleared; do
  for stream in out err; do sed "s/^/$run, $stream: /" "$root$work/$run.$stream"; done
done
lines() { wc -l <"$root$work/$1"; }
seen="$(lines pushed.out) $(lines pushed.err) $(lines cleared.out) $(lines cleared.err)"
rm -rf -- "$root$work"
[[ $seen == "1 1 1 0" ]] || { echo "changed: $seen lines, where 1 1 1 0 were seen"; exit 1; }
echo "as described: a pushed handler is called, and so is the one beneath it"
