#!/usr/bin/env bash
# Jolt Physics as jolt-physics 1.1.0 on npm: the order of a volume constraint's four vertices.
#
# The header says of Volume::mVertex "indices of the vertices that form the tetrahedron", and the rest volume is
# an absolute value.
# Expected: the order of the vertices does not matter.
# Seen: where (x1 - x0) x (x2 - x0) . (x3 - x0) < 0, the correction of each step has the wrong sign: a vertex that
#   is out of place by a fraction of a millimetre is pushed on, through the opposite face, and the tetrahedron
#   comes to rest turned inside out.  Which winding a mesh has is up to the program that made it.
set -euo pipefail
version=1.1.0
skip() { echo "cannot run here: $*"; exit 77; }
for program in node npm; do command -v "$program" >/dev/null || skip "$program is missing"; done
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd "$folder"
npm install --silent --ignore-scripts --no-audit --no-fund "jolt-physics@$version" >/dev/null 2>&1 ||
  skip "npm has no jolt-physics $version"
cat >flip.mjs <<'END'
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

// Returns the height of the apex after 5 s; the base is fixed at height 0.
function settle(order) {
  const shared = new Jolt.SoftBodySharedSettings();
  [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0]].forEach((p, i) => {
    const vertex = new Jolt.SoftBodySharedSettingsVertex();
    vertex.mPosition = new Jolt.Float3(...p);
    vertex.mInvMass = i === 3 ? 10 : 0;
    shared.mVertices.push_back(vertex);
  });
  shared.AddFace(new Jolt.SoftBodySharedSettingsFace(0, 1, 2, 0));
  shared.mVolumeConstraints.push_back(new Jolt.SoftBodySharedSettingsVolume(...order, 1e-3));
  shared.CalculateVolumeConstraintVolumes();
  const restVolume = shared.mVolumeConstraints.at(0).mSixRestVolume / 6;
  shared.Optimize();
  const creation = new Jolt.SoftBodyCreationSettings(shared, new Jolt.RVec3(0, 0, 0), new Jolt.Quat(0, 0, 0, 1), 0);
  creation.mLinearDamping = 2;
  creation.mAllowSleeping = creation.mUpdatePosition = false;
  const body = bodies.CreateSoftBody(creation);
  bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
  for (let i = 0; i < 300; ++i) world.Step(1 / 60, 1);
  const motion = Jolt.castObject(body.GetMotionProperties(), Jolt.SoftBodyMotionProperties);
  const height = motion.GetVertex(3).mPosition.GetY();
  bodies.RemoveBody(body.GetID());
  console.log(`order ${order}: rest volume ${restVolume.toFixed(4)} m^3, apex from 1 m to ${height.toFixed(4)} m`);
  return height;
}
const heights = [settle([0, 1, 2, 3]), settle([0, 2, 1, 3])];
if (Math.abs(heights[0] - 1) > 0.01 || Math.abs(heights[1] + 1) > 0.01) {
  console.log("this has changed");
  process.exit(1);
}
END
node flip.mjs
