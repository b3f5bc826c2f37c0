// Whether a new frame is worth drawing.

const differs = (a, b, tolerance) => {
  for (let i = 0; i < a.length; ++i) if (Math.abs(a[i] - b[i]) > tolerance) return true;
  return false;
};

/// A turn of a rigid part that cannot be seen, in components of its quaternion; a share of the longest arrow.
const SMALL_TURN = 1e-3, SMALL_SHARE = 0.01;

/// Returns whether a frame looks different from another.
/// @param length_m  difference of positions that cannot be seen
/// @param ranges  {force_n, torque_n_m} of the longest arrows
export function looksDifferent(frame, other, length_m, { force_n, torque_n_m }) {
  const poseDiffers = (a, b) => differs(a.subarray(0, 3), b.subarray(0, 3), length_m) ||
    differs(a.subarray(3), b.subarray(3), SMALL_TURN);
  return frame.bodies.some((x, i) => differs(x, other.bodies[i], length_m)) ||
    frame.tools.some((pose, i) => poseDiffers(pose, other.tools[i])) ||
    frame.bones.some((pose, i) => poseDiffers(pose, other.bones[i])) ||
    frame.hands.some(({ pose, force, torque }, i) => poseDiffers(pose, other.hands[i].pose) ||
      differs(force, other.hands[i].force, SMALL_SHARE * force_n) ||
      differs(torque, other.hands[i].torque, SMALL_SHARE * torque_n_m));
}
