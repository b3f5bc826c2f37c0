// A soft body: its skin, embedded in tetrahedra whose nodes the server sends.
import {
  BufferAttribute, BufferGeometry, DataTexture, DynamicDrawUsage, FloatType, GLSL3, Matrix3, Mesh,
  NearestFilter, RGBAFormat, ShaderMaterial, Vector3,
} from "three";
import { withCreases } from "./creases.js";
import { embedSkin, facing, skinAtRest } from "./embedding.js";
import { NodalGradient } from "./nodal_gradient.js";
import { screenColour } from "./ramp.js";
import { largestDisplacement, noMotion, rigidFit } from "./rigid_fit.js";
import { fragmentShader, NODES_PER_ROW, vertexShader } from "./skin_shader.js";
import { alongCurve } from "./triangle_order.js";

/// The vertices to draw: {triangles, position, normal, corner, weight}, at rest.
function skinOf(shape) {
  const { tets, tet, weights, triangles } = shape, rest = skinAtRest(shape);
  const drawn = withCreases(rest, alongCurve(rest, triangles)), count = drawn.source.length;
  const skin = { triangles: drawn.triangles, normal: drawn.normals, position: new Float32Array(3 * count),
    corner: new Uint32Array(4 * count), weight: new Float32Array(4 * count) };
  drawn.source.forEach((v, i) => {
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

export class Body {
  /// `onProcessor` embeds the skin in the tetrahedra here and not in the vertex shader.
  constructor(description, shape, ramp, onProcessor) {
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
      glslVersion: GLSL3, defines: onProcessor ? { LIT_VERTICES: 1 } : { EMBEDDED: 1 } });
    this.mesh = new Mesh(this.makeGeometry(skinOf(shape), onProcessor), material);
    this.mesh.frustumCulled = false;  // it is not where its positions at rest are
    this.move(shape.rest);
  }

  makeGeometry(skin, onProcessor) {
    const geometry = new BufferGeometry(), add = (name, array, size) => {
      const attribute = new BufferAttribute(array, size);
      geometry.setAttribute(name, attribute);
      return attribute;
    };
    geometry.setIndex(new BufferAttribute(onProcessor ? skin.triangles.slice() : skin.triangles, 1));
    add("position", skin.position, 3);
    if (onProcessor) {
      this.skin = skin;
      this.moving = ["moved", "turned"].map((name) => add(name, new Float32Array(skin.position.length), 3));
      for (const one of [...this.moving, geometry.index]) one.setUsage(DynamicDrawUsage);
    } else {
      add("normal", skin.normal, 3);
      add("corner", skin.corner, 4);
      add("weight", skin.weight, 4);
    }
    return geometry;
  }

  /// Moves the nodes to x [m]; displacement_m is then their largest one.
  move(x) {
    this.x = x;
    const rows = this.texture.image.data;
    this.gradient.write(x, rows);
    if (this.moving) {
      embedSkin(rows, this.skin, this.moving[0].array, this.moving[1].array);
      for (const one of this.moving) one.needsUpdate = true;
    } else this.texture.needsUpdate = true;
    const fit = this.attached ? noMotion : rigidFit(this.rest, x);
    this.values.fitRotation.value.set(...fit.rotation);
    this.values.fitTranslation.value.set(...fit.translation);
    this.displacement_m = largestDisplacement(this.rest, x, fit);
  }

  /// Leaves out triangles that are not seen from `eye`: an emulated card would compute half of the skin in
  /// vain.
  lookFrom(eye) {
    if (!this.moving) return;
    const { geometry } = this.mesh, count = facing(this.skin.triangles, this.moving[0].array, eye,
      geometry.index.array);
    geometry.setDrawRange(0, count);
    geometry.index.clearUpdateRanges();
    geometry.index.addUpdateRange(0, count);
    geometry.index.needsUpdate = true;
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
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.texture.dispose();
  }
}
