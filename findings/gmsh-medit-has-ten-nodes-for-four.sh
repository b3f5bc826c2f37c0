#!/usr/bin/env bash
# Gmsh 4.8.4 (Debian 12, libgmsh4.8 4.8.4+ds2-3): a mesh of second order saved in the format MEDIT (.mesh).
#
# MEDIT's "Tetrahedra" have four nodes and a reference each; for ten nodes the format has "TetrahedraP2".
# Expected: the file has TetrahedraP2, or Tetrahedra with the corners only, or Gmsh refuses.
# Seen: the keyword is Tetrahedra, and each line has ten nodes and a reference.  A reader that goes by the format
#   and not by lines takes the fifth node for the reference, and nodes of one tetrahedron for the next one's.
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
call("gmshInitialize", 0, None, 0)
call("gmshOptionSetNumber", b"General.Terminal", ctypes.c_double(0))
call("gmshOpen", b"box.geo")
call("gmshModelMeshGenerate", 3)
call("gmshModelMeshSetOrder", 2)
call("gmshWrite", b"box.mesh")
lines = [line.split() for line in open("box.mesh")]
keywords = [line[0] for line in lines if line and line[0][0].isalpha()]
start = lines.index(["Tetrahedra"]) if "Tetrahedra" in keywords else -1
count = int(lines[start + 1][0])
columns = {len(line) for line in lines[start + 2:start + 2 + count]}
words = [word for line in lines[start + 2:start + 2 + count] for word in line]
read = [words[5 * i:5 * i + 5] for i in range(count)]
same = sum(read[i] == line[:4] + line[-1:] for i, line in enumerate(lines[start + 2:start + 2 + count]))
print("keywords:", *keywords)
print(f"{count} Tetrahedra of {columns} numbers; the first: {' '.join(lines[start + 2])}")
references = sorted({int(tetrahedron[4]) for tetrahedron in read})
print(f"read as four nodes and a reference: {same} of {count} right, references {references[:8]} ...")
sys.exit(0 if "TetrahedraP2" not in keywords and columns == {11} and same == 0 else "this has changed")
END
