// Mouse and touch screen: they move the handle, or the view.
import { Vector3 } from "three";

const TURN_PER_PIXEL = 0.008, ORBIT_PER_PIXEL = 0.006, ZOOM_PER_PIXEL = 0.0015;
/// One notch of a wheel, 100 pixels, moves the handle by 2 % of the view's radius.
const DEPTH_PER_PIXEL = 2e-4;
const WHEEL_PIXELS = [1, 33, 400];  // of a pixel, a line, a page
/// So close to the tool a press takes it [pixels].
const REACH_PX = 44;
/// Two fingers pinch once their distance has changed by so much [pixels].
const PINCH_PX = 14;

/// What a drag does that begins so: "move" or "turn" the handle, "orbit" or "pan" the view.
function actionOf(event, handle, near) {
  if (event.button === 1) return "pan";
  if (event.button === 2) return event.shiftKey ? "pan" : "orbit";
  if (event.altKey || !(handle.held || handle.wanted || near)) return event.shiftKey ? "pan" : "orbit";
  return event.shiftKey ? "turn" : "move";
}

export class Pointer {
  /// `chooseHand(hand)` is called when a press is near the tool of that hand.
  constructor(stage, handle, chooseHand) {
    Object.assign(this, { stage, handle, chooseHand, camera: stage.camera, action: null });
    this.fingers = new Map();
    const { canvas } = stage;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /// The hand whose tool or handle is nearest to the pointer, or -1 where none is near.
  handNear({ offsetX, offsetY }) {
    const { stage, camera } = this;
    if (!stage.frame || !stage.description) return -1;
    let nearest = -1, least = 1;  // distance, in parts of the reach
    stage.description.hands.forEach(({ live }, hand) => {
      if (!live) return;
      const tool = stage.toolOf(hand), poses = [stage.frame.hands[hand].pose];
      if (tool >= 0) poses.push(stage.frame.tools[tool]);
      for (const pose of poses) {
        const at = new Vector3(pose[0], pose[1], pose[2]), { x, y } = camera.onScreen(at);
        const reach = Math.max(REACH_PX, stage.toolRadii[hand] / camera.metresPerPixel(at));
        const distance = Math.hypot(x - offsetX, y - offsetY) / reach;
        if (distance < least) least = distance, nearest = hand;
      }
    });
    return nearest;
  }

  down(event) {
    this.stage.canvas.focus({ preventScroll: true });
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.fingers.size > 1) return this.beginTwo();
    const near = this.handle.holder === "other" ? -1 : this.handNear(event);
    this.action = actionOf(event, this.handle, near >= 0);
    if (near < 0 || this.action === "orbit" || this.action === "pan") return;
    this.chooseHand(near);
    if (!this.handle.held) this.handle.take();
  }

  move(event) {
    const last = this.fingers.get(event.pointerId);
    if (!last) return;
    const right = event.clientX - last.x, down = event.clientY - last.y;
    if (this.fingers.size === 2) return this.moveTwo(event, last, right, down);
    Object.assign(last, { x: event.clientX, y: event.clientY });
    if (this.action === "move") this.drag(right, down);
    else if (this.action === "turn") this.turn(right, down);
    else if (this.action === "pan") this.camera.pan(right, down), this.stage.viewChanged();
    else if (this.action === "orbit") this.orbit(right, down);
  }

  distanceOfTwo() {
    const [a, b] = [...this.fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  }

  beginTwo() {
    this.pinches = false;
    this.apart = this.distanceOfTwo();
  }

  /// Two fingers orbit; apart and together they move the handle in depth, or zoom.
  moveTwo(event, last, right, down) {
    const before = this.distanceOfTwo();
    Object.assign(last, { x: event.clientX, y: event.clientY });
    const after = this.distanceOfTwo();
    this.pinches ||= Math.abs(after - this.apart) > PINCH_PX;
    if (!this.pinches) return this.orbit(right / 2, down / 2);
    if (this.handle.held) this.depth(10 * DEPTH_PER_PIXEL * (after - before));
    else if (before > 1 && after > 1) this.camera.zoom(before / after), this.stage.viewChanged();
  }

  up(event) {
    this.fingers.delete(event.pointerId);
    if (this.fingers.size === 0) this.action = null;
    else this.action = "none";  // of two fingers one is left: it does nothing until it is lifted, too
  }

  drag(right_px, down_px) {
    const { right, up } = this.camera.axes(), size = this.camera.metresPerPixel(this.handle.position);
    this.handle.moveBy(right.multiplyScalar(size * right_px).addScaledVector(up, -size * down_px));
  }

  turn(right_px, down_px) {
    const { right, up } = this.camera.axes();
    this.handle.turnBy(up, TURN_PER_PIXEL * right_px);
    this.handle.turnBy(right, TURN_PER_PIXEL * down_px);
  }

  /// Moves the handle away from the eye by a share of the view's radius.
  depth(share) {
    this.handle.moveBy(this.camera.axes().into.multiplyScalar(share * this.camera.radius_m));
  }

  orbit(right_px, down_px) {
    this.camera.orbit(ORBIT_PER_PIXEL * right_px, ORBIT_PER_PIXEL * down_px);
    this.stage.viewChanged();
  }

  wheel(event) {
    event.preventDefault();
    const pixels = (event.deltaY || event.deltaX) * WHEEL_PIXELS[event.deltaMode];  // Shift scrolls sideways
    if (this.handle.held && event.shiftKey) this.handle.turnBy(this.camera.axes().into, 0.001 * pixels);
    else if (this.handle.held && !event.ctrlKey) this.depth(-DEPTH_PER_PIXEL * pixels);
    else {
      this.camera.zoom(Math.exp(ZOOM_PER_PIXEL * pixels * (event.ctrlKey ? 4 : 1)));
      this.stage.viewChanged();
    }
  }
}
