// The scene in three dimensions. It is drawn when something changed, at most once per frame of the screen.
import { AmbientLight, DirectionalLight, Group, Scene, Vector3, WebGLRenderer } from "three";
import { Body } from "./body.js";
import { Camera } from "./camera.js";
import { HandView } from "./hand_view.js";
import { niceAbove } from "./numbers.js";
import { looksDifferent } from "./visible_change.js";
import { rampTexture } from "./ramp.js";
import { makeSolid, place, radiusOf } from "./solids.js";

/// A rasteriser on the processor, which smooth edges would cost more than half of the frames.
function isSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return null;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software/i.test(name);
}

/// The range of colours shrinks only after the displacement has been smaller for so long [s].
const SHRINK_AFTER_S = 4;

/// An emulated card draws so many triangles of skins and pixels in less than a thirtieth of a second.  It
/// draws the whole skins once nothing has moved for STILL_MS.
const MOST_TRIANGLES = 15000, MOST_PIXELS = 1.2e6, STILL_MS = 350;

/// A part of a pixel that cannot be seen.
const QUARTER_PIXEL = 0.25;

/// The dent shows through the tool.
const TOOL_OPACITY = 0.55;

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    const software = isSoftware();
    this.works = software !== null;
    // for tests: an emulated card embeds like a real one
    this.onProcessor = software && !new URLSearchParams(location.search).has("embed");
    if (!this.works) return;
    // opaque, so that the browser need not blend it with the page
    const context = canvas.getContext("webgl2", { alpha: false, antialias: !software, stencil: false,
      powerPreference: "high-performance" });
    this.renderer = new WebGLRenderer({ canvas, context });
    this.software = software;
    this.scene = new Scene();
    this.camera = new Camera();
    this.ramp = rampTexture();
    this.parts = new Group();
    this.scene.add(this.parts, new AmbientLight(0xffffff, 1.1), this.camera.lens);
    for (const [position, strength] of [[[-0.46, 0.62, 0.64], 2.0], [[0.75, -0.1, 0.65], 0.6]]) {
      const lamp = new DirectionalLight(0xffffff, strength);
      lamp.position.set(...position);
      this.camera.lens.add(lamp, lamp.target);  // they follow the eye
    }
    this.colours = { background: "#fff", handle: "#000", force: "#000", torque: "#000" };
    this.ranges = { force_n: 0, torque_n_m: 0 };
    this.range_m = null;
    this.coloured = true;
    this.frames = 0;
    this.clear();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  clear() {
    for (const one of [...(this.bodies || []), ...(this.hands || [])]) one.dispose();
    this.parts.traverse((one) => { one.geometry?.dispose(); one.material?.dispose(); });
    this.parts.clear();
    this.bodies = [];
    this.tools = [];
    this.bones = [];
    this.hands = [];
    this.frame = null;
    this.pending = null;
  }

  /// Shows another scene, or one whose parts were assembled anew; `keepView` for the latter.
  load(scene, shapes, keepView) {
    this.clear();
    this.description = scene;
    const triangles = scene.bodies.reduce((sum, one) => sum + one.triangles, 0);
    this.bodies = scene.bodies.map((one, i) => new Body(one, shapes.bodies[i], this.ramp,
      this.onProcessor ? Math.ceil((MOST_TRIANGLES * one.triangles) / triangles) : null));
    this.tools = scene.tools.map((one, i) => makeSolid({ ...one, opacity: TOOL_OPACITY }, shapes.tools[i]));
    this.bones = scene.bones.map((one, i) => makeSolid(one, shapes.bones[i]));
    const obstacles = scene.obstacles.map((one, i) => makeSolid(one, shapes.obstacles[i]));
    if (this.bones.length > 0) for (const body of this.bodies) body.seeThrough(0.55);
    this.hands = scene.hands.map((_, hand) => {
      const tool = this.toolOf(hand);
      return new HandView(tool < 0 ? 0 : radiusOf(shapes.tools[tool]));
    });
    this.toolRadii = this.hands.map((one) => one.radius_m);
    this.parts.add(...this.bodies.map((one) => one.mesh), ...this.tools, ...this.bones, ...obstacles,
      ...this.hands.map((one) => one.object));
    for (const hand of this.hands) hand.colour(this.colours), hand.object.visible = false;
    this.viewIsSet = keepView;
    this.peaks = [];
    this.colour();
    this.redraw();
  }

  /// Shows which of several hands the page moves.
  chooseHand(chosen) {
    this.hands.forEach((one, hand) => one.choose(hand === chosen));
    this.redraw();
  }

  toolOf(hand) {
    return this.description.tools.findIndex((one) => one.hand === hand);
  }

  /// Draws a frame, unless it looks like the one that is drawn.
  show(frame) {
    if (!this.pending && this.frame) {
      const length_m = QUARTER_PIXEL * this.camera.metresPerPixel(this.camera.target);
      if (!looksDifferent(frame, this.frame, length_m, this.ranges)) return;
    }
    this.pending = frame;
    this.redraw();
  }

  redraw() {
    if (this.asked || !this.works) return;
    this.asked = requestAnimationFrame(() => this.draw(false));
  }

  /// Draws the newest frame; all triangles of its bodies, or as many as an emulated card can move.
  draw(whole = true) {
    this.asked = 0;
    clearTimeout(this.still);
    if (this.pending) this.move(this.pending);
    for (const body of this.bodies) body.prepare(whole);
    this.renderer.render(this.scene, this.camera.lens);
    ++this.frames;
    if (whole || !this.bodies.some((one) => one.isCoarse)) return;
    this.still = setTimeout(() => this.draw(), STILL_MS);
  }

  move(frame) {
    this.frame = frame;
    this.pending = null;
    this.bodies.forEach((body, i) => body.move(frame.bodies[i]));
    this.tools.forEach((tool, i) => place(tool, frame.tools[i]));
    this.bones.forEach((bone, i) => place(bone, frame.bones[i]));
    if (!this.viewIsSet) this.resetView();
    this.moveHands();
    this.colour();
  }

  moveHands() {
    const scales = { view_m: this.camera.radius_m, ...this.ranges };
    this.hands.forEach((view, hand) => {
      const tool = this.toolOf(hand);
      view.object.visible = true;
      view.move(this.frame.hands[hand], tool < 0 ? null : this.frame.tools[tool], scales);
    });
  }

  /// Colours bodies over a range that grows at once and shrinks slowly.
  colour() {
    const now = performance.now() / 1000;
    const most = Math.max(0, ...this.bodies.map((one) => one.displacement_m));
    this.peaks = this.peaks.filter((one) => one.value > most && one.at > now - SHRINK_AFTER_S);
    this.peaks.push({ at: now, value: most });
    this.range_m = Math.max(niceAbove(this.peaks[0].value), niceAbove(2e-3 * this.sceneRadius()));
    for (const body of this.bodies) body.colourBy(this.coloured ? this.range_m : null);
  }

  /// The range shrinks also while nothing moves.
  updateRange() {
    if (!this.frame) return;
    const before = this.range_m;
    this.colour();
    if (this.range_m !== before) this.redraw();
  }

  sceneRadius() {
    const { min, max } = this.description.bounds;
    return 0.5 * Math.hypot(...max.map((one, k) => one - min[k])) || 1;
  }

  /// Looks at the place of contact: from the first hand's tool to the nearest node of a body.
  resetView() {
    const { min, max } = this.description.bounds;
    const centre = new Vector3(...max.map((one, k) => 0.5 * (one + min[k]))), whole = this.sceneRadius();
    this.camera.setUp(new Vector3(...this.description.up));
    this.viewIsSet = true;
    const tool = this.hands.length > 0 ? this.toolOf(0) : -1;
    if (!this.frame || tool < 0) this.camera.lookAt(centre, whole, new Vector3(0, 1, 0));
    else {
      const at = new Vector3(...this.frame.tools[tool]), nearest = this.nearestNode(at) || centre;
      const gap = nearest.distanceTo(at), near = Math.max(0.62 * whole, 5 * this.toolRadii[0], 2 * gap);
      const radius = Math.min(1.02 * whole, near), approach = nearest.clone().sub(at);
      if (!(approach.length() > 1e-9)) approach.copy(centre).sub(at);
      // between the place of contact and the middle of everything: as far as the view is from the whole
      const target = at.add(nearest).multiplyScalar(0.5).lerp(centre, Math.min(1, radius / whole));
      this.camera.lookAt(target, radius, approach.normalize());
    }
    if (this.frame) this.moveHands();
    this.redraw();
  }

  nearestNode(point) {
    let best = null, least = Infinity;
    for (const { x } of this.bodies)
      for (let i = 0; i < x.length; i += 3) {
        const square = (x[i] - point.x) ** 2 + (x[i + 1] - point.y) ** 2 + (x[i + 2] - point.z) ** 2;
        if (square < least) least = square, best = [x[i], x[i + 1], x[i + 2]];
      }
    return best && new Vector3(...best);
  }

  /// The camera was moved: what has its size on the screen follows.
  viewChanged() {
    if (this.frame) this.moveHands();
    this.redraw();
  }

  setColours(colours) {
    this.colours = colours;
    this.renderer.setClearColor(colours.background, 1);
    for (const hand of this.hands) hand.colour(colours);
    this.redraw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    const most = this.software ? Math.min(1, Math.sqrt(MOST_PIXELS / (width * height))) : 2;
    this.renderer.setPixelRatio(Math.min(most, devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    this.camera.resize(width, height);
    this.redraw();
  }
}
