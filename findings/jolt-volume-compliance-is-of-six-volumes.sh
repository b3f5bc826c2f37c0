#!/usr/bin/env bash
# Jolt Physics as jolt-physics 1.1.0 on npm: the compliance of a soft body's volume constraint.
#
# The header calls Volume::mCompliance the "inverse of the stiffness of the constraint", as it does for an edge.
# Expected: the constraint's energy is (V - V0)^2 / (2 compliance) with the tetrahedron's volume V, so that a
#   bulk modulus K wants the compliance V0 / K.  (For an edge it is (l - l0)^2 / (2 compliance), and that holds.)
# Seen: the energy is (6 V - 6 V0)^2 / (2 compliance).  The body is 36 times as stiff against compression as its
#   compliance says.
#
# A tetrahedron of height 1 m on a fixed base of 1/2 m^2, its apex with a mass of 0.1 kg under gravity: the apex
# sinks by 36 m g compliance/m^4 where V is constrained, and by a 36th of that where 6 V is.
set -euo pipefail
version=1.1.0
skip() { echo "cannot run here: $*"; exit 77; }
for program in node npm; do command -v "$program" >/dev/null || skip "$program is missing"; done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund "jolt-physics@$version" >/dev/null 2>&1 ||
  skip "npm has no jolt-physics $version"
cat >sag.mjs <<'END'
import load from "jolt-physics";
const Jolt = await load();
const settings = new Jolt.JoltSettings();
const pairs = new Jolt.ObjectLayerPairFilterTable(1);
const layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
settings.mObjectLayerPairFilter = pairs;
settings.mBroadPhaseLayerInterface = layers;
settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, pairs, 1);
const world = new Jolt.JoltInterface(settings);
const bodies = world.GetPhysicsSystem().GetBodyInterface();

// Returns the height of the last vertex, the only one that is free, after 20 s.
function settle(vertices, mass, constrain) {
  const shared = new Jolt.SoftBodySharedSettings();
  vertices.forEach((p, i) => {
    const vertex = new Jolt.SoftBodySharedSettingsVertex();
    vertex.mPosition = new Jolt.Float3(...p);
    vertex.mInvMass = i === vertices.length - 1 ? 1 / mass : 0;
    shared.mVertices.push_back(vertex);
  });
  shared.AddFace(new Jolt.SoftBodySharedSettingsFace(0, 1, 2, 0));
  constrain(shared);
  shared.Optimize();
  const creation = new Jolt.SoftBodyCreationSettings(shared, new Jolt.RVec3(0, 0, 0), new Jolt.Quat(0, 0, 0, 1), 0);
  creation.mLinearDamping = 2;
  creation.mAllowSleeping = creation.mUpdatePosition = false;
  const body = bodies.CreateSoftBody(creation);
  bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
  for (let i = 0; i < 1200; ++i) world.Step(1 / 60, 1);
  const motion = Jolt.castObject(body.GetMotionProperties(), Jolt.SoftBodyMotionProperties);
  const height = motion.GetVertex(vertices.length - 1).mPosition.GetY();
  bodies.RemoveBody(body.GetID());
  return height;
}

const mass = 0.1, gravity = 9.81, compliance = 1e-3;
const hung = -1 - settle([[0, 0, 0], [0.1, 0, 0], [0, -1, 0]], mass, (shared) => {
  shared.mEdgeConstraints.push_back(new Jolt.SoftBodySharedSettingsEdge(0, 2, compliance));
  shared.CalculateEdgeLengths();
});
const sank = 1 - settle([[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0]], mass, (shared) => {
  shared.mVolumeConstraints.push_back(new Jolt.SoftBodySharedSettingsVolume(0, 1, 2, 3, compliance));
  shared.CalculateVolumeConstraintVolumes();
});
const weight = mass * gravity * compliance;
console.log(`an edge of that compliance: longer by ${hung.toExponential(3)} m, expected ${weight.toExponential(3)} m`);
console.log(`a volume: apex lower by ${sank.toExponential(3)} m, expected ${(36 * weight).toExponential(3)} m`);
const near = (a, b) => Math.abs(a / b - 1) < 0.02;
if (!near(hung, weight) || !near(sank, weight)) {
  console.log("this has changed");
  process.exit(1);
}
END
node sag.mjs
