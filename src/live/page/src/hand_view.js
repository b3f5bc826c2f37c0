// A hand in the view: the handle as an outline, the virtual spring to the tool, force and torque as arrows.
import {
  BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion,
  TorusGeometry, Vector3,
} from "three";
import { place } from "./solids.js";

const ALONG = new Vector3(0, 1, 0);

/// Drawn over everything else: it may lie inside a body, and is too slender to hide it.
function overlay(opacity) {
  return new MeshBasicMaterial({ transparent: true, opacity, depthTest: false, depthWrite: false });
}

/// Three rings about the axes of the handle: they show where it is and how it is turned.
function makeOutline(material) {
  const outline = new Group();
  for (const axis of ["x", "y", "z"]) {
    const ring = new Mesh(new TorusGeometry(1, 0.035, 6, 40), material);
    if (axis !== "z") ring.rotation[axis] = Math.PI / 2;
    ring.renderOrder = 5;
    outline.add(ring);
  }
  return outline;
}

/// A coil of unit length and width along y, as a strip of quads about its centre line.
function coilGeometry() {
  const turns = 9, steps = turns * 14, sides = 5, thickness = 0.16, position = [], index = [];
  for (let i = 0; i <= steps; ++i) {
    const along = i / steps, angle = 2 * Math.PI * turns * along;
    const width = Math.min(1, 12 * along, 12 * (1 - along));  // both ends lie on the axis
    for (let s = 0; s < sides; ++s) {
      const around = (2 * Math.PI * s) / sides, out = width + thickness * Math.cos(around);
      position.push(out * Math.cos(angle), along + (thickness / 24) * Math.sin(around),
        out * Math.sin(angle));
    }
  }
  for (let i = 0; i < steps; ++i)
    for (let s = 0; s < sides; ++s) {
      const a = i * sides + s, b = i * sides + ((s + 1) % sides);
      index.push(a, b, a + sides, b, b + sides, a + sides);
    }
  const geometry = new BufferGeometry();
  geometry.setIndex(index);
  geometry.setAttribute("position", new BufferAttribute(Float32Array.from(position), 3));
  return geometry;
}

class Arrow {
  /// heads: 1 for a force, 2 for a torque.
  constructor(heads) {
    this.material = overlay(0.95);
    this.object = new Group();
    this.shaft = new Mesh(new CylinderGeometry(1, 1, 1, 10).translate(0, 0.5, 0), this.material);
    this.heads = Array.from({ length: heads }, () =>
      new Mesh(new ConeGeometry(1, 1, 14).translate(0, -0.5, 0), this.material));
    this.object.add(this.shaft, ...this.heads);
    for (const one of this.object.children) one.renderOrder = 6;
  }
  /// An arrow of `length` along `vector`, its shaft of radius `width`; too short to have a head: none.
  point(vector, length, width) {
    const head = 6 * width, all = head * this.heads.length;
    this.object.visible = length > 0.3 * head;
    if (!this.object.visible) return;
    const shrink = Math.min(1, length / (1.2 * all));
    this.object.quaternion.setFromUnitVectors(ALONG, vector.clone().normalize());
    this.shaft.scale.set(width * shrink, Math.max(1e-9, length - shrink * all), width * shrink);
    this.heads.forEach((one, k) => {
      one.position.y = length - k * 0.75 * head * shrink;
      one.scale.set(2.4 * width * shrink, head * shrink, 2.4 * width * shrink);
    });
  }
}

export class HandView {
  constructor(radius_m) {
    this.radius_m = radius_m;
    this.object = new Group();
    this.material = overlay(0.9);
    this.springMaterial = overlay(0.65);
    this.outline = makeOutline(this.material);
    this.spring = new Mesh(coilGeometry(), this.springMaterial);
    this.spring.renderOrder = 4;
    this.force = new Arrow(1);
    this.torque = new Arrow(2);
    this.object.add(this.outline, this.spring, this.force.object, this.torque.object);
    for (const child of this.object.children) child.traverse((one) => { one.frustumCulled = false; });
    this.turn = new Quaternion();
  }

  /// Shows that this is the hand that the page moves, or one of the others.
  choose(isChosen) {
    this.material.opacity = isChosen ? 0.9 : 0.3;
  }

  colour({ handle, force, torque }) {
    this.material.color.set(handle);
    this.springMaterial.color.set(handle);
    this.force.material.color.set(force);
    this.torque.material.color.set(torque);
  }

  /// @param hand  of a frame
  /// @param tool  pose of its tool, or null
  /// @param scales  {view_m: radius of what is seen, force_n, torque_n_m: of the longest arrows}
  move(hand, tool, { view_m, force_n, torque_n_m }) {
    place(this.outline, hand.pose);
    this.outline.scale.setScalar(Math.max(0.8 * this.radius_m, 0.025 * view_m));
    const from = new Vector3(...(tool || hand.pose)), to = new Vector3(...hand.pose);
    const stretched = to.clone().sub(from), length = stretched.length(), width = 0.014 * view_m;
    this.spring.visible = tool !== null && length > 0.02 * view_m;
    this.spring.position.copy(from);
    this.spring.scale.set(width, Math.max(1e-9, length), width);
    if (this.spring.visible) this.spring.quaternion.setFromUnitVectors(ALONG, stretched.divideScalar(length));
    const longest = 0.7 * view_m, thin = 0.008 * view_m;
    const arrows = [[this.force, hand.force, force_n], [this.torque, hand.torque, torque_n_m]];
    for (const [arrow, value, most] of arrows) {
      const vector = new Vector3(...value);
      arrow.object.position.copy(from);
      arrow.point(vector, most > 0 ? (longest * vector.length()) / most : 0, thin);
    }
  }

  dispose() {
    this.object.traverse((one) => one.geometry?.dispose());
    const { material, springMaterial, force, torque } = this;
    for (const one of [material, springMaterial, force.material, torque.material]) one.dispose();
  }
}
