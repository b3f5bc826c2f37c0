// The page of `palpate touch`: connects the server, the view, the devices and the panel.
import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { Handle } from "./handle.js";
import { LIMITED } from "./messages.js";
import {
  element, forgetRun, notice, showForce, showHint, showHolder, showLegend, showState,
} from "./panel.js";
import { Pointer } from "./pointer.js";
import { RAMP } from "./ramp.js";
import { Rates } from "./rates.js";
import { Scenes } from "./scenes.js";
import { Stage } from "./stage.js";
import { StripChart } from "./strip_chart.js";

const stage = new Stage(element("view"));
const chart = new StripChart(element("chart"));
const send = (message) => connection.send(message);
const handle = new Handle(send), controls = new Controls(send), scenes = new Scenes(send);
let scene = null, ranges = chart.ranges(), shown = 0;

function drawRamp() {
  const canvas = element("ramp"), pen = canvas.getContext("2d");
  const shades = pen.createLinearGradient(0, 0, canvas.width, 0);
  RAMP.forEach((colour, k) => shades.addColorStop(k / (RAMP.length - 1), colour));
  pen.fillStyle = shades;
  pen.fillRect(0, 0, canvas.width, canvas.height);
}

/// Colours of the style sheet, as they are now: they change with the reader's dark mode.
function followTheme() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  stage.setColours({ background: colour("stage"), handle: colour("handle"), force: colour("force"),
    torque: colour("torque") });
  chart.draw();
}

/// The page may change something while nobody else holds the handle.
function showHolding() {
  showHolder(handle);
  showHint(handle);
  const mine = handle.holder !== "other";
  controls.allow(mine);
  scenes.allowed = mine;
}

/// Moves this hand and shows its force.
function chooseHand(hand) {
  if (!scene?.hands[hand]) return;
  handle.choose(hand);
  chart.show(hand);
  stage.chooseHand(hand);
  element("hand").value = hand;
  element("force-title").textContent = scene.hands.length < 2 ? "Force on the hand"
    : `Force on hand ${hand + 1}, ${scene.hands[hand].name}`;
  showHolding();
}

function setHands() {
  handle.setHands(scene.hands);
  element("hand").replaceChildren(...scene.hands.map(({ name, live }, hand) =>
    new Option(`${hand + 1}: ${name}${live ? "" : " (device)"}`, hand)));
  element("hand").hidden = scene.hands.length < 2;
  element("reading").hidden = element("force").hidden = scene.hands.length === 0;
  chooseHand(Math.max(0, handle.hand));
}

const on = {
  scene(description, shapes) {
    const isAnother = description.scene !== scene?.scene;
    scene = description;
    document.title = `${scene.scene} \u2013 palpate touch`;
    element("scene-name").textContent = `${scene.scene}, ${scene.integrator}, ${scene.scheme}`;
    scenes.current = scene.scene;
    stage.load(scene, shapes, !isAnother);
    chart.reset(scene.hands.length);
    forgetRun();
    setHands();
    controls.setSliders(scene.sliders || []);
    showHolding();
  },
  frame(frame) {
    handle.follow(frame);
    chart.add(frame);
    ranges = chart.ranges();
    Object.assign(stage.ranges, ranges);
    stage.show(frame);
    const hand = frame.hands[Math.max(0, handle.hand)];
    if (!hand) return;
    showForce(hand, frame.time_s, ranges);
    element("limited").hidden = !(hand.flags & LIMITED);
    handle.strength = Math.hypot(...hand.force) /
      (scene.hands[Math.max(0, handle.hand)].max_force_n || ranges.force_n);
  },
  state(state) {
    if (!scene) return;
    if (state.holder !== handle.holder) handle.setHolder(state.holder);
    showHolding();
    showState(state, scene);
    controls.show(state);
    stage.updateRange();
    if (stage.range_m && stage.range_m !== shown) showLegend(shown = stage.range_m);
    element("legend").dataset.displacement = Math.max(0, ...stage.bodies.map((one) => one.displacement_m));
    element("busy").hidden = !state.message;
    element("busy").textContent = state.message || "";
    element("chart").setAttribute("aria-label", `Force and torque of ${chart.summary()}`);
  },
  notice: ({ level, text }) => notice(level, text),
  recorded: (message) => controls.recorded(message),
  link(state, pause_s) {
    const text = { connected: "connected", ended: "palpate has ended",
      waiting: "no connection" }[state];
    element("link").textContent = text;
    element("link").classList.toggle("bad", state !== "connected");
    element("cover").hidden = state === "connected";
    if (state !== "connected") {
      handle.setHolder("nobody");
      showHolding();
      controls.allow(false);
      element("busy").hidden = true;
    }
    const again = Number.isFinite(pause_s) ? ` Trying again in ${Math.ceil(pause_s)} s.` : "";
    element("cover-text").textContent = state === "ended"
      ? "palpate has ended. Start `palpate touch` again and open the address that it prints."
      : `The connection to palpate is lost.${again}`;
  },
};

const toggleHandle = () => (handle.holder === "you" ? handle.drop() : handle.take());
const resetView = () => { if (scene) stage.resetView(); };

function connectButtons() {
  element("take").addEventListener("click", () => {
    toggleHandle();
    element("view").focus({ preventScroll: true });
  });
  element("reset-view").addEventListener("click", resetView);
  element("open-controls").addEventListener("click", () => element("controls").showModal());
  element("again").addEventListener("click", () => connection.open());
  element("hand").addEventListener("change", ({ target }) => chooseHand(Number(target.value)));
  element("coloured").addEventListener("change", ({ target }) => {
    stage.coloured = target.checked;
    element("legend").hidden = !target.checked;
    if (scene) stage.colour(), stage.redraw();
  });
  element("components").addEventListener("change", ({ target }) => {
    chart.components = target.checked;
    element("chart-key").querySelector("span").hidden = !target.checked;
    chart.draw();
  });
}

function connectDevices() {
  new Pointer(stage, handle, chooseHand);
  const zoom = (factor) => { stage.camera.zoom(factor); stage.viewChanged(); };
  const hands = Object.fromEntries([..."123456789"].map((key) => [key, () => chooseHand(key - 1)]));
  new Rates(stage, handle, {
    key: { ...hands, t: toggleHandle, 0: resetView,
      Escape: () => { if (handle.holder === "you") handle.drop(); },
      " ": () => controls.pause(), "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1 / 0.9) },
    padTakes: toggleHandle,
    padChooses: () => chooseHand((handle.hand + 1) % scene.hands.length),
    padConnected: ({ id }) => notice("info", `game pad: ${id}. A takes the handle`),
    strength: () => handle.strength || 0,
  });
}

let connection = null;
drawRamp();
connectButtons();
if (stage.works) {
  connectDevices();
  followTheme();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", followTheme);
  connection = new Connection(on);
} else {
  element("cover").hidden = false;
  element("again").hidden = true;
  element("cover-text").textContent = "The view needs WebGL 2, which this browser does not offer.";
}
/// For tests: frames drawn so far, and triangles of the last one; draws one, whose pixels can be read until
/// the script returns; where the tool of a hand is in the window, once a frame is drawn.
window.palpateTest = {
  frames: () => stage.frames,
  triangles: () => stage.renderer.info.render.triangles,
  draw: (whole) => stage.draw(whole),
  tool: (hand = 0) => {
    if (!stage.frame) return null;
    const { x, y } = stage.camera.onScreen(stage.tools[stage.toolOf(hand)].position);
    const { left, top } = stage.canvas.getBoundingClientRect();
    return [left + x, top + y];
  },
};
