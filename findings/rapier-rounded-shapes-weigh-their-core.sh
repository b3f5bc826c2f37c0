#!/usr/bin/env bash
# Rapier 0.21.0 on npm (@dimforge/rapier3d-compat): mass of rounded shapes.
#
# roundCuboid(hx, hy, hz, r) is a cuboid of these half extents, grown by r on all sides: a ball touches it at a
#   distance of hx + r from its centre.
# Expected: mass and inertia under a density are those of the shape that collides.  With half extents of 0.5 m and
#   r = 0.25 m the volume is 1 + 6 r + 3 pi r^2 + 4/3 pi r^3 = 3.154 m^3 (Steiner's formula).
# Seen: volume() is 1 m^3, and the body weighs 1000 kg at 1000 kg/m^3: the border has no mass.  roundCylinder
#   likewise.  Weight, inertia, and the period of every spring that carries the body are wrong by a factor of three.
set -euo pipefail
version=0.21.0
skip() { echo "cannot run here: $*"; exit 77; }
for program in node npm; do command -v "$program" >/dev/null || skip "$program is missing"; done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund "@dimforge/rapier3d-compat@$version" >/dev/null 2>&1 ||
  skip "npm has no @dimforge/rapier3d-compat $version"
cat >mass.mjs <<'END'
import RAPIER from "@dimforge/rapier3d-compat";
await RAPIER.init();
const world = new RAPIER.World({ x: 0, y: 0, z: 0 });
const none = { x: 0, y: 0, z: 0 }, unturned = { x: 0, y: 0, z: 0, w: 1 };
const r = 0.25, half = 0.5;
const measured = (description) => {
  const body = world.createRigidBody(RAPIER.RigidBodyDesc.dynamic());
  const collider = world.createCollider(description.setDensity(1000), body);
  world.step();
  return { volume: collider.volume(), mass: body.mass() };
};
const box = measured(RAPIER.ColliderDesc.roundCuboid(half, half, half, r));
const rod = measured(RAPIER.ColliderDesc.roundCylinder(half, half, r));
const distance = new RAPIER.RoundCuboid(half, half, half, r)
  .contactShape(none, unturned, new RAPIER.Ball(0.1), { x: 2, y: 0, z: 0 }, unturned, 10).distance;
const borderCollides = Math.abs(distance - (2 - 0.1 - half - r)) < 1e-4;
const sizes = `volume ${box.volume.toFixed(3)}, mass ${box.mass.toFixed(0)}`;
console.log(`round cuboid: ${sizes}; expected 3.154 and 3154; its border collides: ` +
  `${borderCollides}`);
console.log(`round cylinder: volume ${rod.volume.toFixed(3)}; that of its core is 0.785`);
const same = Math.abs(box.volume - 1) < 1e-4 && Math.abs(box.mass - 1000) < 0.1 &&
  Math.abs(rod.volume - Math.PI / 4) < 1e-4 && borderCollides;
if (!same) {
  console.log("this has changed");
  process.exit(1);
}
END
node mass.mjs
