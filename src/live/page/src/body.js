// A soft body: its skin, embedded in tetrahedra whose nodes the server sends.
import {
  BufferAttribute, BufferGeometry, DataTexture, DynamicDrawUsage, FloatType, GLSL3, Matrix3, Mesh,
  NearestFilter, RGBAFormat, ShaderMaterial, Vector3,
} from "three";
import { coarser } from "./coarse_skin.js";
import { withCreases } from "./creases.js";
import { embedSkin, skinAtRest } from "./embedding.js";
import { NodalGradient } from "./nodal_gradient.js";
import { screenColour } from "./ramp.js";
import { largestDisplacement, noMotion, rigidFit } from "./rigid_fit.js";
import { fragmentShader, NODES_PER_ROW, vertexShader } from "./skin_shader.js";
import { alongCurve } from "./triangle_order.js";

/// The vertices to draw: {triangles, position, normal, corner, weight}, at rest.
function skinOf({ tets, tet, weights }, rest, { source, normals, triangles }) {
  const count = source.length;
  const skin = { triangles, normal: normals, position: new Float32Array(3 * count),
    corner: new Uint32Array(4 * count), weight: new Float32Array(4 * count) };
  source.forEach((v, i) => {
    skin.position.set(rest.subarray(3 * v, 3 * v + 3), 3 * i);
    skin.corner.set(tets.subarray(4 * tet[v], 4 * tet[v] + 4), 4 * i);
    skin.weight.set(weights.subarray(4 * v, 4 * v + 4), 4 * i);
  });
  return skin;
}

function nodeTexture(nodes) {
  const rows = Math.max(1, Math.ceil(nodes / NODES_PER_ROW)), width = 3 * NODES_PER_ROW;
  const texture = new DataTexture(new Float32Array(4 * width * rows), width, rows, RGBAFormat, FloatType);
  texture.minFilter = texture.magFilter = NearestFilter;
  return texture;
}

function geometryOf({ triangles }, attributes) {
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(triangles, 1));
  for (const [name, array, size] of attributes)
    geometry.setAttribute(name, new BufferAttribute(array, size));
  return geometry;
}

/// A skin that the graphics card embeds in the tetrahedra.
const embeddedGeometry = (skin) => geometryOf(skin, [["position", skin.position, 3],
  ["normal", skin.normal, 3], ["corner", skin.corner, 4], ["weight", skin.weight, 4]]);

/// A skin that the processor embeds.
class ProcessorSkin {
  constructor(skin) {
    this.skin = skin;
    this.geometry = geometryOf(skin, [["position", skin.position, 3],
      ...["moved", "turned"].map((name) => [name, new Float32Array(skin.position.length), 3])]);
    this.moving = ["moved", "turned"].map((name) => this.geometry.getAttribute(name));
    for (const one of this.moving) one.setUsage(DynamicDrawUsage);
  }

  /// Moves the nodes to x, with the rows [F x] of them.
  move(x, rows) {
    if (x === this.x) return;
    this.x = x;
    embedSkin(rows, this.skin, ...this.moving.map((one) => one.array));
    for (const one of this.moving) one.needsUpdate = true;
  }
}

export class Body {
  /// @param most  triangles to draw while something moves, on an emulated card; null: a graphics card embeds
  /// and draws the whole skin
  constructor(description, shape, ramp, most) {
    this.rest = shape.rest;
    this.attached = description.attached === true;
    this.gradient = new NodalGradient(shape.rest, shape.tets);
    this.texture = nodeTexture(shape.rest.length / 3);
    this.values = {
      nodes: { value: this.texture }, ramp: { value: ramp }, stops: { value: ramp.image.width },
      coloured: { value: true }, fitRotation: { value: new Matrix3() },
      fitTranslation: { value: new Vector3() }, inverseRange: { value: 0 },
      plain: { value: screenColour(description.colour) }, opacity: { value: 1 },
    };
    const material = new ShaderMaterial({ vertexShader, fragmentShader, uniforms: this.values,
      glslVersion: GLSL3, defines: most === null ? { EMBEDDED: 1 } : {} });
    this.mesh = new Mesh(this.makeGeometry(shape, most), material);
    this.mesh.frustumCulled = false;  // it is not where its positions at rest are
    this.move(shape.rest);
  }

  makeGeometry(shape, most) {
    const rest = skinAtRest(shape), triangles = alongCurve(rest, shape.triangles);
    const drawn = withCreases(rest, triangles);
    if (most === null) return embeddedGeometry(skinOf(shape, rest, drawn));
    this.fine = this.coarse = new ProcessorSkin(skinOf(shape, rest, drawn));
    if (3 * most < triangles.length)
      this.coarse = new ProcessorSkin(skinOf(shape, rest, coarser(rest, triangles, drawn, most)));
    return this.fine.geometry;
  }

  /// Moves the nodes to x [m]; displacement_m is then their largest one.
  move(x) {
    this.x = x;
    this.gradient.write(x, this.texture.image.data);
    if (!this.fine) this.texture.needsUpdate = true;
    const fit = this.attached ? noMotion : rigidFit(this.rest, x);
    this.values.fitRotation.value.set(...fit.rotation);
    this.values.fitTranslation.value.set(...fit.translation);
    this.displacement_m = largestDisplacement(this.rest, x, fit);
  }

  /// Whether it is drawn by fewer triangles while something moves.
  get isCoarse() { return this.fine !== this.coarse; }

  /// To be called before it is drawn, by all its triangles or by few.
  prepare(whole) {
    if (!this.fine) return;
    const skin = whole ? this.fine : this.coarse;
    skin.move(this.x, this.texture.image.data);
    this.mesh.geometry = skin.geometry;
  }

  /// Colours displacement from zero to range_m, or not at all for null.
  colourBy(range_m) {
    this.values.coloured.value = range_m !== null;
    this.values.inverseRange.value = range_m ? 1 / range_m : 0;
  }

  seeThrough(opacity) {
    this.values.opacity.value = opacity;
    this.mesh.material.transparent = opacity < 1;
    this.mesh.renderOrder = opacity < 1 ? 1 : 0;
  }

  dispose() {
    for (const one of [this.mesh, this.fine, this.coarse]) one?.geometry.dispose();
    this.mesh.material.dispose();
    this.texture.dispose();
  }
}
