#!/usr/bin/env bash
# MuJoCo 3.14.0 as @mujoco/mujoco 3.14.0 on npm: Young's modulus and Poisson's ratio of a flex.
#
# The elasticity of a flex is called a Saint Venant-Kirchhoff model; "young" is Young's modulus and "poisson"
# Poisson's ratio.
# Expected: under a small strain e the stress is 2 mu e + lambda tr(e), with Lame's mu = E/(2 (1 + nu)) and
#   lambda = E nu/((1 + nu)(1 - 2 nu)), for every parametrisation of a solid; in a sheet of thickness 1, with
#   lambda = E nu/(1 - nu^2) of plane stress.
# Seen: three materials for the same two numbers.  Tetrahedra (dof="full") have 2 lambda; trilinear and quadratic
#   cells have mu/2; triangles with elastic2d="stretch" have mu/4 and half of the solid's lambda.  E = 1000 Pa and
#   nu = 0.3 act as 1058 Pa and 0.375, as 529 Pa and 0.375, and as 308 Pa and 0.6.  With nu = 0 tetrahedra are right,
#   cells have half of E and sheets a quarter.
#
# The stress is read from qfrc_spring, the elastic forces on the vertices: -sum(f x)/volume.
set -euo pipefail
version=3.14.0
skip() { echo "cannot run here: $*"; exit 77; }
for program in node npm; do command -v "$program" >/dev/null || skip "$program is missing"; done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund "@mujoco/mujoco@$version" >/dev/null 2>&1 ||
  skip "npm has no @mujoco/mujoco $version"
cat >moduli.mjs <<'END'
import load from "@mujoco/mujoco";
const mujoco = await load();
const young = 1000, strain = 1e-5;

// Lame's mu and lambda that the forces of one body have, from a shear and a stretch; every vertex is free.
function moduli(flexcomp, poisson, dimensions) {
  const model = mujoco.MjModel.from_xml_string(`<mujoco><option gravity="0 0 0" integrator="discrete"/><worldbody>
    <flexcomp name="body" mass="1" radius="0.01" ${flexcomp}>
    <contact contype="0" conaffinity="0" internal="false" selfcollide="none"/>
    <elasticity young="${young}" poisson="${poisson}"${dimensions === 2 ? ' thickness="1" elastic2d="stretch"' : ""}/>
    </flexcomp></worldbody></mujoco>`);
  const data = new mujoco.MjData(model);
  mujoco.mj_forward(model, data);
  const points = Array.from({ length: model.nv / 3 }, (_, i) => Array.from(data.xpos).slice(3 * i + 3, 3 * i + 6));
  const size = points[0].map((_, axis) => Math.max(...points.map((p) => p[axis] - points[0][axis])));
  const volume = flexcomp.includes("direct") ? 1 / (dimensions === 2 ? 2 : 6) : size[0] * size[1] * size[2];
  const stress = (gradient, row, column) => {
    points.forEach((p, i) => gradient.forEach((line, axis) => {
      data.qpos[3 * i + axis] = strain * line.reduce((sum, entry, k) => sum + entry * p[k], 0);
    }));
    mujoco.mj_forward(model, data);
    return -points.reduce((sum, p, i) => sum + data.qfrc_spring[3 * i + row] * p[column], 0) / volume / strain;
  };
  const mu = stress([[0, 1, 0], [1, 0, 0], [0, 0, 0]], 0, 1) / 2;
  const lambda = stress([[1, 0, 0], [0, 0, 0], [0, 0, 0]], 1, 1);
  return [mu, lambda];
}

const solid = (e, nu) => [e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))];
const sheet = (e, nu) => [e / (2 * (1 + nu)), e * nu / (1 - nu * nu)];
const grid = 'type="grid" dim="3" count="3 3 3" spacing="0.5 0.5 0.5"';
const bodies = [
  ["tetrahedron", 'type="direct" dim="3" point="0 0 0 1 0 0 0 1 0 0 0 1" element="0 1 2 3"', 3, (m, l) => [m, 2 * l]],
  ["trilinear cube", `${grid} dof="trilinear"`, 3, (m, l) => [m / 2, l]],
  ["quadratic cube", `${grid} dof="quadratic"`, 3, (m, l) => [m / 2, l]],
  ["triangle", 'type="direct" dim="2" point="0 0 0 1 0 0 0 1 0" element="0 1 2"', 2, (m, l) => [m / 4, l / 2]],
];
console.log(`MuJoCo ${mujoco.mj_versionString()}, young = ${young}`);
let same = true;
for (const poisson of [0, 0.3, 0.45]) {
  for (const [name, flexcomp, dimensions, seen] of bodies) {
    const [mu, lambda] = moduli(flexcomp, poisson, dimensions);
    const right = (dimensions === 2 ? sheet : solid)(young, poisson);
    const [e, nu] = dimensions === 2
      ? [4 * mu * (lambda + mu) / (lambda + 2 * mu), lambda / (lambda + 2 * mu)]
      : [mu * (3 * lambda + 2 * mu) / (lambda + mu), lambda / (2 * (lambda + mu))];
    console.log(`poisson = ${poisson}, ${name}: mu ${mu.toFixed(1)} (expected ${right[0].toFixed(1)}), lambda ` +
      `${lambda.toFixed(1)} (${right[1].toFixed(1)}): Young's modulus ${e.toFixed(0)}, Poisson's ratio ${nu.toFixed(3)}`);
    const expected = seen(...solid(young, poisson));
    same &&= [mu, lambda].every((value, i) => Math.abs(value - expected[i]) < 2e-3 * young);
  }
}
if (!same) {
  console.log("this has changed");
  process.exit(1);
}
END
node moduli.mjs
