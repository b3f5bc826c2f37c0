#!/usr/bin/env bash
# SciPy 1.10.1 (Debian 12: python3-scipy 1.10.1-2): the angular rate of scipy.spatial.transform.RotationSpline.
#
# The documentation says "angular rate in rad/sec".  A Rotation takes vectors of the body to the frame of reference.
# Expected: the rate is the angular velocity in the frame of reference, that of Rotation's own vectors: for
#   R(t) = exp(t [w]) R0 it is w.
# Seen: it is that in the frame of the body, R0^-1 w.  (The accelerations are the body's, too.)  A recorded pose whose
#   handle is tilted has its velocity about other axes.
package=python3-scipy version=1.10.1-2
set -euo pipefail
skip() { echo "cannot run here: $*"; exit 77; }
[[ -x /usr/bin/python3 ]] || skip "/usr/bin/python3 is missing"
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
if [[ $(dpkg-query -W -f='${Version}' "$package" 2>/dev/null) != "$version" ]]; then
  apt-get -s --no-install-recommends install "$package=$version" >plan 2>/dev/null ||
    skip "apt has no $package $version"
  sed -nE 's/^Inst ([^ ]+) .*\(([^ ]+) .*/\1=\2/p' plan | xargs apt-get download >/dev/null 2>&1 || skip "no network"
  for archive in *.deb; do dpkg -x "$archive" .; done
  lib=$folder/usr/lib/$(uname -m)-linux-gnu
  export PYTHONPATH=$folder/usr/lib/python3/dist-packages LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack
fi
/usr/bin/python3 - <<'END'
import sys
import numpy
from scipy.spatial.transform import Rotation, RotationSpline

w = numpy.array([0.0, 0.0, 2.0])
tilt = Rotation.from_rotvec([1.0, 0.0, 0.0])
times = numpy.linspace(0.0, 1.0, 21)
poses = Rotation.from_rotvec(times[:, None] * w) * tilt
rate = RotationSpline(times, poses)(0.5, 1)
step = 1e-6
spline = RotationSpline(times, poses)
difference = (spline(0.5 + step) * spline(0.5 - step).inv()).as_rotvec() / (2 * step)
print("turned about z at 2 rad/s, by differences of the poses:", difference.round(6))
print("the spline's rate:", rate.round(6), "and in the frame of the body:", tilt.inv().apply(w).round(6))
as_described = numpy.allclose(difference, w, atol=1e-6) and numpy.allclose(rate, tilt.inv().apply(w), atol=1e-9)
sys.exit(0 if as_described else "this has changed")
END
