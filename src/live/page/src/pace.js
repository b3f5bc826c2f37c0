// When the scene is drawn, and how sharply.

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

const SHARES = [1, 0.8, 0.65, 0.5], SLOW_MS = 34, WINDOW_MS = 700, STILL_MS = 350;

/// Share of the pixels per side that an emulated card draws while the scene moves: fewer where it does not
/// reach 30 frames per second, and all of them once the scene is still.
export class Sharpness {
  /// `apply(share)` changes the size of the picture and draws it again.
  constructor(apply) {
    Object.assign(this, { apply, step: 0, shown: 1, frames: 0, draws: 0, began_ms: 0 });
  }

  received() { ++this.frames; }

  /// A frame with something new was drawn.
  drew(now_ms) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.set(1), STILL_MS);
    if (now_ms - this.began_ms > 2 * WINDOW_MS) this.begin(now_ms);
    ++this.draws;
    const passed_ms = now_ms - this.began_ms;
    if (passed_ms > WINDOW_MS) {
      const behind = this.frames > 1.15 * this.draws && passed_ms > SLOW_MS * this.draws;
      if (behind && this.step < SHARES.length - 1) ++this.step;
      this.begin(now_ms);
    }
    this.set(SHARES[this.step]);
  }

  begin(now_ms) {
    this.began_ms = now_ms;
    this.frames = this.draws = 0;
  }

  set(share) {
    if (share === this.shown) return;
    this.shown = share;
    this.apply(share);
  }
}
