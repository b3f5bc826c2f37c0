// Positions over time, unpacked from the page, and the colours of displacement.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, MeshLambertMaterial } from "three";

const LEVELS = 65535;
const TOOL_COLOUR = 0x8a94a0;

function bytesOf(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/// Little-endian unsigned 16-bit numbers.
function numbersOf(base64) {
  const bytes = bytesOf(base64), view = new DataView(bytes.buffer);
  return Uint16Array.from({ length: bytes.length / 2 }, (_, i) => view.getUint16(2 * i, true));
}

/// Viridis (Smith and van der Walt 2015) by five of its colours, as the pictures have it: 0 to 1.
export const RAMP = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"];
const COLOURS = RAMP.map((name) => new Color(name));
function rampAt(share, out) {
  const at = Math.min(0.9999, Math.max(0, share)) * (COLOURS.length - 1), i = Math.floor(at);
  return out.lerpColors(COLOURS[i], COLOURS[i + 1], at - i);
}

function makePart(part, data) {
  const size = data.high_m.map((high, k) => high - data.low_m[k]);
  const unpack = (quantised, from, target) => {
    for (let i = 0; i < target.length; ++i)
      target[i] = data.low_m[i % 3] + (size[i % 3] * quantised[from + i]) / LEVELS;
  };
  const count = 3 * part.vertices, quantised = numbersOf(part.positions);
  const [rest, positions, colours] = [1, 2, 3].map(() => new Float32Array(count));
  unpack(numbersOf(part.rest), 0, rest);
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(numbersOf(part.faces), 1));
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  const coloured = part.kind === "body";
  if (coloured) geometry.setAttribute("color", new BufferAttribute(colours, 3));
  const material = new MeshLambertMaterial({ side: DoubleSide, vertexColors: coloured,
    color: coloured ? 0xffffff : TOOL_COLOUR });
  const colour = new Color();
  const show = (step) => {
    unpack(quantised, step * count, positions);
    for (let i = 0; coloured && i < count; i += 3) {
      const moved = Math.hypot(...[0, 1, 2].map((k) => positions[i + k] - rest[i + k]));
      rampAt(data.most_displacement_m > 0 ? moved / data.most_displacement_m : 0, colour).toArray(colours, i);
    }
    for (const name of Object.keys(geometry.attributes)) geometry.attributes[name].needsUpdate = true;
    geometry.computeVertexNormals();
  };
  return { geometry, material, show };
}

export function makeMotion(data) {
  const parts = data.parts.map((part) => makePart(part, data));
  const centre = data.low_m.map((low, k) => (low + data.high_m[k]) / 2);
  for (const { geometry } of parts) geometry.boundingSphere = null;
  return {
    parts,
    times_s: data.times_s,
    first_shown: data.first_shown,
    most_displacement_m: data.most_displacement_m,
    centre_m: centre,
    radius_m: Math.hypot(...data.low_m.map((low, k) => (data.high_m[k] - low) / 2)),
    show(step) {
      for (const part of parts) part.show(step), part.geometry.computeBoundingSphere();
    },
  };
}
