// Binary messages of the server (docs/live.md), little endian like every browser's machine.
export const SUBPROTOCOL = "palpate-touch-1";
export const GEOMETRY = 1, FRAME = 2;
export const POSE_VALID = 1, LIMITED = 2, IN_CONTACT = 4;

const HEADER_BYTES = 8;

/// Reads one message from its start to its end; what is left over or missing is an error of either side.
class Reader {
  constructor(buffer) {
    this.buffer = buffer;
    this.at = HEADER_BYTES;
  }
  take(Type, count) {
    const bytes = count * Type.BYTES_PER_ELEMENT;
    if (this.at + bytes > this.buffer.byteLength)
      throw new Error(`message of ${this.buffer.byteLength} bytes ends within an array that needs ` +
        `${this.at + bytes - this.buffer.byteLength} bytes more`);
    const out = new Type(this.buffer, this.at, count);
    this.at += bytes;
    return out;
  }
  floats(count) { return this.take(Float32Array, count); }
  indices(count) { return this.take(Uint32Array, count); }
  end() {
    if (this.at !== this.buffer.byteLength)
      throw new Error(`message of ${this.buffer.byteLength} bytes has ${this.buffer.byteLength - this.at} ` +
        "bytes after its last array");
  }
}

export function kindOf(buffer) {
  const [kind, length] = new Uint32Array(buffer, 0, 2);
  if (length !== buffer.byteLength)
    throw new Error(`message of ${buffer.byteLength} bytes says that it has ${length}`);
  return kind;
}

/// Shapes at rest: {bodies: [{rest, tets, tet, weights, triangles}], tools, bones, obstacles}.
export function readGeometry(buffer, scene) {
  const reader = new Reader(buffer);
  const solid = ({ vertices, triangles }) =>
    ({ vertices: reader.floats(3 * vertices), triangles: reader.indices(3 * triangles) });
  const bodies = scene.bodies.map(({ nodes, vertices, triangles, tets }) => ({
    rest: reader.floats(3 * nodes), tets: reader.indices(4 * tets), tet: reader.indices(vertices),
    weights: reader.floats(4 * vertices), triangles: reader.indices(3 * triangles),
  }));
  const shapes = { bodies, tools: scene.tools.map(solid), bones: scene.bones.map(solid),
    obstacles: scene.obstacles.map(solid) };
  reader.end();
  return shapes;
}

const SAMPLE = 7;  // time, force, torque

/// Everything that moves, at one time: {time_s, bodies, tools, bones, hands, samples}.  samples[hand] has
/// SAMPLE numbers per sample: time after that of the frame [s], force [N], torque [N m].
export function readFrame(buffer, scene) {
  const reader = new Reader(buffer), [time_s] = reader.take(Float64Array, 1);
  const [count] = reader.indices(1);
  const frame = {
    time_s,
    bodies: scene.bodies.map(({ nodes }) => reader.floats(3 * nodes)),
    tools: scene.tools.map(() => reader.floats(7)),
    bones: scene.bones.map(() => reader.floats(7)),
    hands: scene.hands.map(() => {
      const pose = reader.floats(7), force = reader.floats(3), torque = reader.floats(3);
      return { pose, force, torque, flags: reader.indices(1)[0] };
    }),
  };
  const hands = scene.hands.length, all = reader.floats(count * hands * SAMPLE);
  frame.samples = scene.hands.map((_, hand) => {
    const own = new Float32Array(count * SAMPLE);
    for (let s = 0; s < count; ++s)
      own.set(all.subarray((s * hands + hand) * SAMPLE, (s * hands + hand + 1) * SAMPLE), s * SAMPLE);
    return own;
  });
  reader.end();
  return frame;
}
