// Steps the beam of soft_beam.py with MuJoCo's WebAssembly build, on one thread.
//
//     node soft_beam.mjs MODULE BEAM.json STEP_S DURATION_S PERIOD_S
//
// BEAM.json: nodes [m], tetrahedra, masses [kg], pinned nodes, node of the tip, gravity, moduli, damping.
// Prints one JSON line: version, deflection of the tip [m] once per period, CPU seconds of the steps.
import { readFileSync } from "fs";
import { pathToFileURL } from "url";

const [, , module, file, step, duration, period] = process.argv;
const { default: load } = await import(pathToFileURL(module).href);
const beam = JSON.parse(readFileSync(file));
const mujoco = await load();
const mass = beam.masses.reduce((sum, m) => sum + m, 0);
const model = mujoco.MjModel.from_xml_string(`<mujoco>
  <size memory="400M"/>
  <option timestep="${step}" integrator="discrete" gravity="0 0 ${-beam.gravity}">
    <flag contact="disable"/></option>
  <worldbody><flexcomp name="beam" type="direct" dim="3" radius="0" mass="${mass}"
      point="${beam.nodes.flat().join(" ")}" element="${beam.tetrahedra.flat().join(" ")}">
    <elasticity young="${beam.young}" poisson="${beam.poisson}" damping="${beam.damping}"/>
    <pin id="${beam.pinned.join(" ")}"/>
  </flexcomp></worldbody></mujoco>`);
const data = new mujoco.MjData(model);

// flexcomp gives all points the same mass; the bodies of the free ones follow the world in their order.
const pinned = new Set(beam.pinned);
const free = beam.masses.filter((_, i) => !pinned.has(i));
if (model.nbody !== free.length + 1) throw new Error(`${model.nbody} bodies for ${free.length} free nodes`);
free.forEach((m, i) => (model.body_mass[i + 1] = m));
mujoco.mj_setConst(model, data);

for (let i = 0; i < 50; ++i) mujoco.mj_step(model, data);  // the optimising compiler takes over meanwhile
mujoco.mj_resetData(model, data);
// The vertices in flexvert_xpos are those before the step; qpos has their displacements after it.
const tip = 3 * beam.masses.slice(0, beam.tip).filter((_, i) => !pinned.has(i)).length + 2;
const each = Math.round(period / step), steps = Math.round(duration / step);
const deflection = [0];
const before = process.cpuUsage();
for (let i = 1; i <= steps; ++i) {
  mujoco.mj_step(model, data);
  if (Math.abs(data.time - i * step) > 1e-9) throw new Error("MuJoCo found the state unstable and reset it");
  if (i % each === 0) deflection.push(data.qpos[tip]);
}
const used = process.cpuUsage(before);
console.log(JSON.stringify({ version: mujoco.mj_versionString(), deflection,
  cpu_s: (used.user + used.system) / 1e6, steps }));
