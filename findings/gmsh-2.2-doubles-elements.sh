#!/usr/bin/env bash
# Gmsh 4.8.4 (Debian 12, libgmsh4.8 4.8.4+ds2-3): a mesh saved in format 2.2 and opened again.
# A volume is in two physical groups.  Format 2.2 has room for one group per element, so that Gmsh writes each
# element once per group.
# Expected: opened again, the mesh has as many tetrahedra as before, in both groups, as with format 4.1.
# Seen: twice as many tetrahedra, each with a copy on the same nodes, without a warning.  The volume of the mesh is
# then twice that of the body.
set -euo pipefail
version=4.8.4+ds2-3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ $(dpkg-query -W -f='${Version}' libgmsh4.8 2>/dev/null) != "$version" ]]; then
  apt-get download "libgmsh4.8=$version" >/dev/null
  dpkg -x libgmsh4.8_*.deb .
  export LD_LIBRARY_PATH=$folder/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
fi
cat >box.geo <<'END'
Point(1) = {0, 0, 0, 0.5};
line[] = Extrude {1, 0, 0} { Point{1}; };
face[] = Extrude {0, 1, 0} { Curve{line[1]}; };
body[] = Extrude {0, 0, 1} { Surface{face[1]}; };
Physical Volume("all") = {body[1]};
Physical Volume("soft") = {body[1]};
END
python3 - <<'END'
import ctypes, sys
gmsh = ctypes.CDLL("libgmsh.so.4.8")
error = ctypes.c_int()

def call(name, *arguments):
    getattr(gmsh, name)(*arguments, ctypes.byref(error))
    assert error.value == 0, name

def option(name, value):
    call("gmshOptionSetNumber", name, ctypes.c_double(value))

def tetrahedra():
    tags, nodes = ctypes.POINTER(ctypes.c_size_t)(), ctypes.POINTER(ctypes.c_size_t)()
    n, m = ctypes.c_size_t(), ctypes.c_size_t()
    call("gmshModelMeshGetElementsByType", 4, ctypes.byref(tags), ctypes.byref(n), ctypes.byref(nodes),
         ctypes.byref(m), -1, ctypes.c_size_t(0), ctypes.c_size_t(1))
    distinct = {tuple(sorted(nodes[4 * i:4 * i + 4])) for i in range(n.value)}
    return n.value, len(distinct)

call("gmshInitialize", 0, None, 0)
option(b"General.Terminal", 0)
call("gmshOpen", b"box.geo")
call("gmshModelMeshGenerate", 3)
made = tetrahedra()
seen = {}
for version in (4.1, 2.2):
    option(b"Mesh.MshFileVersion", version)
    call("gmshWrite", f"{version}.msh".encode())
for version in (4.1, 2.2):
    call("gmshClear")
    call("gmshOpen", f"{version}.msh".encode())
    seen[version] = tetrahedra()
print(f"tetrahedra, and different sets of nodes: made {made}, from 4.1 {seen[4.1]}, from 2.2 {seen[2.2]}")
if seen != {4.1: made, 2.2: (2 * made[0], made[1])}:
    sys.exit("this has changed")
END
