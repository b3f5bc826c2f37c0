#!/usr/bin/env bash
# three.js 0.187.0 on npm: OBJLoader and an object with faces and lines.
#
# Expected: an OBJ object may hold `f` and `l` elements side by side (a skin with its feature edges, as CAD programs
#   write it).  The loader makes a mesh of the faces, and line segments of the lines.
# Seen: the whole object becomes one LineSegments whose positions are those of faces and lines in one list: there is
#   no mesh, and pairs of vertices of the triangles are drawn as lines.  Without the `l` element it is a Mesh.
set -euo pipefail
version=0.187.0
skip() { echo "cannot run here: $*"; exit 77; }
for program in node npm; do command -v "$program" >/dev/null || skip "$program is missing"; done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund "three@$version" >/dev/null 2>&1 ||
  skip "npm has no three $version"
cat >tetrahedron.mjs <<'END'
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
const faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const warnings = [];
console.warn = console.error = (...words) => warnings.push(words.join(" "));
const kinds = (text) => new OBJLoader().parse(text).children
  .map((child) => `${child.type} of ${child.geometry.attributes.position.count} positions`).join(", ");
const without = kinds(faces), before = kinds(faces.replace("f 1 3 2", "l 1 2\nf 1 3 2")),
  after = kinds(faces + "l 1 2\n");
console.log(`a tetrahedron: ${without}\nwith one edge before its faces: ${before}\nafter them: ${after}\n` +
  `warnings: ${warnings.length}`);
const same = without === "Mesh of 12 positions" && before === "LineSegments of 14 positions" &&
  after === before && !warnings.length;
if (!same) {
  console.log("this has changed");
  process.exit(1);
}
END
node tetrahedron.mjs
