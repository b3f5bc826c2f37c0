// Positions over time, unpacked from the page, and the colours of displacement.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, MeshLambertMaterial,
} from "three";

const LEVELS = 65535;

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

/// The colours of the page's data, evenly spaced: 0 to 1.
function makeRamp(names) {
  const colours = names.map((name) => new Color(name));
  return (share, out) => {
    const at = Math.min(0.9999, Math.max(0, share)) * (colours.length - 1), i = Math.floor(at);
    return out.lerpColors(colours[i], colours[i + 1], at - i);
  };
}

/// How far a point is from its place at rest; of a free body after its rigid motion.
function displacement(positions, rest, i, motion) {
  let sum = 0;
  for (let k = 0; k < 3; ++k) {
    const placed = motion
      ? motion[3 * k] * rest[i] + motion[3 * k + 1] * rest[i + 1] + motion[3 * k + 2] * rest[i + 2] +
        motion[9 + k]
      : rest[i + k];
    sum += (positions[i + k] - placed) ** 2;
  }
  return Math.sqrt(sum);
}

/// Tools are translucent: the dent lies under them.
function materialOf(part, coloured) {
  if (coloured) return new MeshLambertMaterial({ side: DoubleSide, vertexColors: true, color: 0xffffff });
  return new MeshLambertMaterial({ side: FrontSide, color: part.colour, transparent: true, opacity: 0.4,
    depthWrite: false });
}

function makePart(part, data, rampAt) {
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
  const material = materialOf(part, coloured);
  const colour = new Color();
  const show = (step) => {
    unpack(quantised, step * count, positions);
    for (let i = 0; coloured && i < count; i += 3) {
      const moved = displacement(positions, rest, i, part.motions && part.motions[step]);
      rampAt(data.most_displacement_m > 0 ? moved / data.most_displacement_m : 0, colour).toArray(colours, i);
    }
    for (const name of Object.keys(geometry.attributes)) geometry.attributes[name].needsUpdate = true;
    geometry.computeVertexNormals();
  };
  return { geometry, material, show };
}

export function makeMotion(data) {
  const rampAt = makeRamp(data.ramp);
  const parts = data.parts.map((part) => makePart(part, data, rampAt));
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
