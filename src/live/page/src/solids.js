// Rigid parts: tools, bones, obstacles.
import { BufferAttribute, BufferGeometry, Mesh, MeshLambertMaterial } from "three";
import { withCreases } from "./creases.js";

export function makeSolid({ colour, opacity = 1 }, { vertices, triangles }) {
  const drawn = withCreases(vertices, triangles), position = new Float32Array(3 * drawn.source.length);
  drawn.source.forEach((v, i) => position.set(vertices.subarray(3 * v, 3 * v + 3), 3 * i));
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(drawn.triangles, 1));
  geometry.setAttribute("position", new BufferAttribute(position, 3));
  geometry.setAttribute("normal", new BufferAttribute(drawn.normals, 3));
  const mesh = new Mesh(geometry,
    new MeshLambertMaterial({ color: colour, opacity, transparent: opacity < 1, depthWrite: opacity === 1 }));
  mesh.frustumCulled = false;
  if (opacity < 1) mesh.renderOrder = 2;
  return mesh;
}

/// Poses are x y z, then the unit quaternion w x y z.
export function place(object, pose) {
  object.position.set(pose[0], pose[1], pose[2]);
  object.quaternion.set(pose[4], pose[5], pose[6], pose[3]);
}

/// Distance of the farthest vertex from the origin of the part's axes.
export function radiusOf({ vertices }) {
  let most = 0;
  for (let i = 0; i < vertices.length; i += 3)
    most = Math.max(most, Math.hypot(vertices[i], vertices[i + 1], vertices[i + 2]));
  return most;
}
