#!/usr/bin/env bash
# Gmsh 4.8.4 (Debian 12, libgmsh4.8 4.8.4+ds2-3): the references of a mesh saved in the format MEDIT (.mesh).
#
# Expected: a tetrahedron of the physical volume 71 has the reference 71, as it has the physical tag 71 in Gmsh's own
#   format, and as only elements of physical groups are saved.
# Seen: the reference is the tag of the geometry's volume, here 1.  Materials or boxes that are chosen by it are those
#   of others, or none; two volumes in one group stay apart.  (Mesh.SaveElementTagType = 2 saves physical tags.)
set -euo pipefail
version=4.8.4+ds2-3
skip() { echo "cannot run here: $*"; exit 77; }
[[ -x /usr/bin/python3 ]] || skip "/usr/bin/python3 is missing"
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
if [[ $(dpkg-query -W -f='${Version}' libgmsh4.8 2>/dev/null) != "$version" ]]; then
  apt-get -s --no-install-recommends install "libgmsh4.8=$version" >plan 2>/dev/null ||
    skip "apt has no libgmsh4.8 $version"
  sed -nE 's/^Inst ([^ ]+) .*\(([^ ]+) .*/\1=\2/p' plan | xargs apt-get download >/dev/null 2>&1 || skip "no network"
  for archive in *.deb; do dpkg -x "$archive" .; done
  lib=$folder/usr/lib/$(uname -m)-linux-gnu
  export LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack
fi
cat >box.geo <<'END'
Point(1) = {0, 0, 0, 1};
line[] = Extrude {1, 0, 0} { Point{1}; };
face[] = Extrude {0, 1, 0} { Curve{line[1]}; };
body[] = Extrude {0, 0, 1} { Surface{face[1]}; };
Physical Volume("soft", 71) = {body[1]};
END
/usr/bin/python3 - <<'END'
import ctypes, sys
gmsh = ctypes.CDLL("libgmsh.so.4.8")
error = ctypes.c_int()
def call(name, *arguments):
    getattr(gmsh, name)(*arguments, ctypes.byref(error))
    assert error.value == 0, name
def references():
    call("gmshWrite", b"box.mesh")
    lines = [line.split() for line in open("box.mesh")]
    start = lines.index(["Tetrahedra"]) + 2
    return {int(line[-1]) for line in lines[start:start + int(lines[start - 1][0])]}
call("gmshInitialize", 0, None, 0)
call("gmshOptionSetNumber", b"General.Terminal", ctypes.c_double(0))
call("gmshOpen", b"box.geo")
call("gmshModelMeshGenerate", 3)
by_default = references()
call("gmshOptionSetNumber", b"Mesh.SaveElementTagType", ctypes.c_double(2))
physical = references()
print("the physical volume is 71; references by default:", by_default, "with Mesh.SaveElementTagType 2:", physical)
sys.exit(0 if by_default == {1} and physical == {71} else "this has changed")
END
