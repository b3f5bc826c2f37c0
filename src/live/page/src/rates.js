// Devices that are held down rather than moved: keys and the sticks of a game pad.
import { readGamePad, rumble } from "./game_pad.js";

/// Speeds of keys and of sticks at their end, in radii of the view and radians per second.
const KEY_SPEED = 0.35, KEY_TURN = 1.2, STICK_SPEED = 0.9, STICK_TURN = 2.5, ORBIT = 1.6;
const LONGEST_STEP_S = 0.05;

/// Direction of each key: right, up, into the view.
const DIRECTIONS = {
  ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0],
  KeyW: [0, 0, 1], KeyS: [0, 0, -1],
};

export class Rates {
  /// `on.key` maps the keys that do something at once to functions; `on.padTakes` and `on.padChooses` are
  /// called for its buttons.
  constructor(stage, handle, on) {
    Object.assign(this, { stage, handle, on, keys: new Set(), shift: false, last_ms: 0, pads: false });
    stage.canvas.addEventListener("keydown", (event) => this.down(event));
    stage.canvas.addEventListener("keyup", (event) => this.up(event));
    stage.canvas.addEventListener("blur", () => this.keys.clear());
    addEventListener("gamepadconnected", ({ gamepad }) => {
      this.pads = true;
      on.padConnected(gamepad);
      this.run();
    });
    addEventListener("gamepaddisconnected", () => {
      this.pads = [...navigator.getGamepads()].some(Boolean);
    });
  }

  down(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    this.shift = event.shiftKey;
    if (DIRECTIONS[event.code]) this.keys.add(event.code), this.run();
    else if (this.on.key[event.key] && !event.repeat) this.on.key[event.key]();
    else return;
    event.preventDefault();
  }

  up(event) {
    this.shift = event.shiftKey;
    this.keys.delete(event.code);
  }

  run() {
    if (this.running) return;
    this.running = true;
    this.last_ms = performance.now();
    requestAnimationFrame((now) => this.step(now));
  }

  step(now_ms) {
    const passed_s = Math.min(LONGEST_STEP_S, Math.max(0, (now_ms - this.last_ms) / 1000));
    this.last_ms = now_ms;
    this.running = this.keys.size > 0 || this.pads;
    if (!this.running) return;
    this.stepKeys(passed_s);
    if (this.pads) this.stepPad(passed_s);
    requestAnimationFrame((then) => this.step(then));
  }

  stepKeys(passed_s) {
    if (this.keys.size === 0) return;
    const sum = [0, 0, 0];
    for (const code of this.keys) DIRECTIONS[code].forEach((one, k) => { sum[k] += one; });
    if (!this.handle.held) this.moveView(sum, passed_s);
    else if (this.shift) this.turn(sum, KEY_TURN * passed_s);
    else this.move(sum, KEY_SPEED * passed_s);
  }

  stepPad(passed_s) {
    const pad = readGamePad();
    if (!pad) return;
    if (pad.takes) this.on.padTakes();
    if (pad.chooses) this.on.padChooses();
    if (!this.handle.held) return this.moveView([pad.left[0], pad.left[1], pad.right[1]], passed_s);
    const sum = [pad.left[0], pad.left[1], pad.right[1]];
    if (pad.turns) this.turn(sum, STICK_TURN * passed_s);
    else this.move(sum, STICK_SPEED * passed_s);
    rumble(pad, this.on.strength());
  }

  move(amounts, scale) {
    if (amounts.every((one) => one === 0)) return;
    const { right, up, into } = this.stage.camera.axes(), size = scale * this.stage.camera.radius_m;
    this.handle.moveBy(right.multiplyScalar(size * amounts[0]).addScaledVector(up, size * amounts[1])
      .addScaledVector(into, size * amounts[2]));
  }

  /// Turns about the upright, the horizontal and the view's own axis.
  turn(amounts, scale) {
    if (amounts.every((one) => one === 0)) return;
    const { right, up, into } = this.stage.camera.axes();
    this.handle.turnBy(up, scale * amounts[0]);
    this.handle.turnBy(right, -scale * amounts[1]);
    this.handle.turnBy(into, scale * amounts[2]);
  }

  moveView([right, up, into], passed_s) {
    if (right === 0 && up === 0 && into === 0) return;
    this.stage.camera.orbit(ORBIT * passed_s * right, -ORBIT * passed_s * up);
    this.stage.camera.zoom(Math.exp(-passed_s * into));
    this.stage.viewChanged();
  }
}
