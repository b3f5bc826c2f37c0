#!/usr/bin/env bash
# MuJoCo 3.3.8 as mujoco-js 0.0.7 on npm: the stiffness and damping of a contact.
#
# solref="-stiffness -damping" is the "direct format" of a contact.
# Expected: a ball that rests on a plane with a stiffness of 10 kN/m sinks in by m g / stiffness: 0.1 mm for 0.1 kg,
#   10 mm for 10 kg.
# Seen: each ball sinks in by 0.108 mm, whatever its mass.  The stiffness is that of an acceleration, in 1/s^2, and is
#   multiplied by the mass that the contact meets.  A stiffness in N/m that was measured or rendered cannot be given:
#   what is felt at a contact follows the mass of the tool.
set -euo pipefail
version=0.0.7
skip() { echo "cannot run here: $*"; exit 77; }
for program in node npm; do command -v "$program" >/dev/null || skip "$program is missing"; done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund "mujoco-js@$version" >/dev/null 2>&1 ||
  skip "npm has no mujoco-js $version"
cat >rest.mjs <<'END'
import load from "mujoco-js";
const mujoco = await load();
mujoco.FS.mkdir("/scene");
mujoco.FS.mount(mujoco.MEMFS, { root: "." }, "/scene");
const stiffness = 1e4;
const depths = [0.1, 1, 10].map((mass) => {
  mujoco.FS.writeFile("/scene/ball.xml", `<mujoco><option timestep="0.001"/><worldbody>
    <geom type="plane" size="1 1 1"/><body pos="0 0 0.1"><freejoint/>
    <geom type="sphere" size="0.1" mass="${mass}" solref="${-stiffness} -100" priority="1"/></body>
    </worldbody></mujoco>`);
  const model = mujoco.MjModel.loadFromXML("/scene/ball.xml");
  const data = new mujoco.MjData(model);
  for (let i = 0; i < 4000; ++i) mujoco.mj_step(model, data);
  const depth = 0.1 - data.qpos[2];
  console.log(`MuJoCo ${mujoco.mj_versionString()}, ${mass} kg: depth ${(1e3 * depth).toFixed(4)} mm, ` +
    `expected ${(1e3 * mass * 9.81 / stiffness).toFixed(4)} mm`);
  return depth;
});
const same = depths.every((depth) => Math.abs(depth / depths[0] - 1) < 1e-3 && depth > 5e-5 && depth < 2e-4);
if (!same) {
  console.log("this has changed");
  process.exit(1);
}
END
node rest.mjs
