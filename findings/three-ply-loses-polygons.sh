#!/usr/bin/env bash
# three.js 0.187.0 on npm: PLYLoader and faces of more than four vertices.
#
# Expected: the list of a PLY face may have any length, and a pentagon becomes three triangles (OBJLoader and
#   VTKLoader of the same package do that), or is refused.
# Seen: faces of three and four vertices are read, longer ones are left out without a word.  A closed prism is then
#   an open tube: no inside, no volume, a tool that goes in at its ends.
set -euo pipefail
version=0.187.0
skip() { echo "cannot run here: $*"; exit 77; }
for program in node npm; do command -v "$program" >/dev/null || skip "$program is missing"; done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund "three@$version" >/dev/null 2>&1 ||
  skip "npm has no three $version"
cat >prism.mjs <<'END'
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
const points = [0, 1].flatMap((z) =>
  [0, 1, 2, 3, 4].map((i) => [Math.cos((2 * Math.PI * i) / 5), Math.sin((2 * Math.PI * i) / 5), z]));
const sides = [0, 1, 2, 3, 4].map((i) => [i, (i + 1) % 5, 5 + ((i + 1) % 5), 5 + i]);
const faces = [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], ...sides];
const rows = (lists) => lists.map((list) => list.join(" ") + "\n").join("");
const ply = `ply\nformat ascii 1.0\nelement vertex 10\nproperty float x\nproperty float y\nproperty float z\n` +
  `element face 7\nproperty list uchar int vertex_indices\nend_header\n` +
  rows(points) + rows(faces.map((face) => [face.length, ...face]));
const obj = rows(points.map((p) => ["v", ...p])) + rows(faces.map((face) => ["f", ...face.map((i) => i + 1)]));
const warnings = [];
console.warn = console.error = (...words) => warnings.push(words.join(" "));
const fromPly = new PLYLoader().parse(new TextEncoder().encode(ply).buffer).index.count / 3;
const fromObj = new OBJLoader().parse(obj).children[0].geometry.attributes.position.count / 3;
console.log(`triangles of a prism on a pentagon: 16 expected, ${fromObj} from OBJ, ${fromPly} from PLY; ` +
  `warnings: ${warnings.length}`);
if (fromObj !== 16 || fromPly !== 10 || warnings.length) {
  console.log("this has changed");
  process.exit(1);
}
END
node prism.mjs
