// What the page says about the run, in words and numbers.
import { short, withUnit } from "./numbers.js";

export const element = (id) => document.getElementById(id);

function light(id, level, text) {
  const item = element(id);
  item.className = level;
  item.querySelector("span").textContent = text;
}

/// A share of ticks this small says nothing about what a hand feels.
const FEW_LATE = 0.01, REAL_TIME = 0.98;

/// Simulated seconds per second over the last few, for scenes without haptic ticks.
const PACE_S = 3;
let paces = [];

function measuredPace({ time_s, running }) {
  const now_s = performance.now() / 1000;
  if (!running || time_s < paces.at(-1)?.time_s) paces = [];
  paces.push({ time_s, now_s });
  while (paces[0].now_s < now_s - PACE_S) paces.shift();
  const [first] = paces;
  return now_s > first.now_s ? (time_s - first.time_s) / (now_s - first.now_s) : 1;
}

function showRate(state, tick_s) {
  const pace = measuredPace(state), share = tick_s > 0 ? state.rate_hz * tick_s : pace;
  const percent = `${short(100 * share, 2)} %`;
  if (!state.running) light("light-rate", "", "paused");
  else if (share >= REAL_TIME) light("light-rate", "good", "runs in real time");
  else light("light-rate", share > 0.8 ? "warn" : "bad", `slower than real time: ${percent} of it`);
}

/// Skipped ticks are shown for so long [s].
const SKIPS_SHOWN_S = 10;
let skips = [];

/// Ticks skipped in the last seconds; the server counts them from the start of the scene.
function recentSkips({ time_s, skipped_ticks }) {
  if (skips.length > 0 && time_s < skips.at(-1).time_s) skips = [];
  skips.push({ time_s, skipped_ticks });
  while (skips[0].time_s < time_s - SKIPS_SHOWN_S) skips.shift();
  return skipped_ticks - skips[0].skipped_ticks;
}

function showLateness(state, tick_s) {
  if (!(tick_s > 0)) return light("light-late", "", "no haptic ticks in this scene");
  const { running, late_share } = state, recent = recentSkips(state);
  const skipped = recent > 0 ? `, ${recent} skipped in ${SKIPS_SHOWN_S} s` : "";
  if (!running) light("light-late", "", "no ticks while paused");
  else if (late_share <= FEW_LATE && recent === 0) light("light-late", "good", "ticks on time");
  else light("light-late", late_share <= 0.1 ? "warn" : "bad",
    `${short(100 * late_share, 2)} % of the ticks late${skipped}`);
}

/// Energies below this are rounding errors of either sum [J].
const NO_ENERGY_J = 1e-7;

function showPassivity({ passivity }, { hands }) {
  if (!passivity?.observed) return light("light-passivity", "", "passivity is not observed");
  const { energy_j, min } = passivity, least = Math.min(energy_j, min ?? energy_j);
  const [who, they] = hands.length > 1 ? ["hands", "they"] : ["hand", "it"];
  const given = withUnit(Math.max(0, energy_j), "J"), got = withUnit(-least, "J");
  if (least >= -NO_ENERGY_J) light("light-passivity", "good", `passive: the ${who} put in ${given}`);
  else light("light-passivity", "bad", `active: the ${who} got ${got} more than ${they} put in`);
}

/// Both energies when the run began, and since when the bodies have had more than the hand put in [s].
let began = null, exceeded_s = null;
const EXCESS_SHARE = 0.1, EXCESS_S = 1.5;

export function forgetRun() {
  began = exceeded_s = null;
  skips = [];
}

/// Bodies can store what the hand puts in, and no more. The two are not of one instant, so that only an
/// excess that lasts says something.
function showEnergy({ energy_j, passivity, time_s }) {
  if (energy_j === null || energy_j === undefined) return light("light-energy", "", "energy is not computed");
  if (!Number.isFinite(energy_j))
    return light("light-energy", "bad", "the energy is not finite: the run has diverged");
  const put_in = passivity?.observed ? passivity.energy_j : NaN;
  if (!began || time_s < began.time_s) began = { energy_j, put_in, time_s }, exceeded_s = null;
  const gained = energy_j - began.energy_j, given = put_in - began.put_in;
  const exceeds = gained > given + EXCESS_SHARE * Math.abs(given) + 1e-5;
  exceeded_s = exceeds ? exceeded_s ?? time_s : null;
  const text = `energy of the bodies ${withUnit(energy_j, "J")}`;
  if (exceeds && time_s - exceeded_s > EXCESS_S)
    light("light-energy", "bad", `${text}: ${withUnit(gained - given, "J")} more than the hand put in`);
  else light("light-energy", "good", text);
}

/// The rows of the table of figures; those about ticks where the scene has a hand.
function figuresOf(state, tick_s) {
  const time = ["simulated time", `${state.time_s.toFixed(1)} s`];
  const viewers = ["viewers", String(state.viewers)];
  if (!(tick_s > 0)) return [time, viewers];
  return [
    time,
    ["rate", state.running ? `${Math.round(state.rate_hz)} of ${short(1 / tick_s)} ticks/s` : "-"],
    ["lateness, 99 %", withUnit(state.late_p99_s, "s", 2)],
    ["work per tick, median", withUnit(state.work_p50_s, "s", 2)],
    ["work per tick, 99 %", withUnit(state.work_p99_s, "s", 2)],
    ["skipped ticks in all", String(state.skipped_ticks)],
    viewers,
  ];
}

export function showState(state, scene) {
  showRate(state, scene.tick_s);
  showLateness(state, scene.tick_s);
  showPassivity(state, scene);
  showEnergy(state);
  const list = element("figures"), rows = figuresOf(state, scene.tick_s);
  if (list.children.length !== 2 * rows.length) {
    list.replaceChildren(...rows.flatMap(() => [document.createElement("dt"), document.createElement("dd")]));
  }
  rows.flat().forEach((text, k) => {
    if (list.children[k].textContent !== text) list.children[k].textContent = text;
  });
}

/// Text that changes with every frame cannot be read, and costs a repaint [ms].
const TEXT_PERIOD_MS = 100;
let written_ms = -Infinity;

/// Force and torque of the hand that is shown, with the exact numbers and their time for programs.
export function showForce(hand, time_s, ranges) {
  const now = performance.now();
  if (now - written_ms < TEXT_PERIOD_MS) return;
  written_ms = now;
  const force = Math.hypot(...hand.force), torque = Math.hypot(...hand.torque);
  const set = (output, value, unit, range) => {
    const milli = range < 0.05, size = milli ? 1e3 * value : value;
    const digits = Math.max(0, Math.min(3, 2 - Math.floor(Math.log10(milli ? 1e3 * range : range))));
    output.textContent = `${size.toFixed(digits)} ${milli ? "m" : ""}${unit}`;
  };
  set(element("force-now"), force, "N", ranges.force_n);
  set(element("torque-now"), torque, "N m", ranges.torque_n_m);
  Object.assign(element("reading").dataset, { time: time_s, force: [...hand.force].join(" "),
    torque: [...hand.torque].join(" "), pose: [...hand.pose].join(" ") });
}

/// One message at the top of the view; the same text is there once. Errors stay until they are closed.
export function notice(level, text, seconds = level === "error" ? 0 : 8) {
  const list = element("notices");
  for (const one of list.children) if (one.firstChild.textContent === text) one.remove();
  const item = document.createElement("li"), said = document.createElement("span");
  const close = document.createElement("button");
  item.className = level;
  said.textContent = text;
  close.type = "button";
  close.textContent = "\u00d7";
  close.setAttribute("aria-label", "close this message");
  close.addEventListener("click", () => item.remove());
  item.append(said, close);
  list.append(item);
  while (list.children.length > 4) list.firstChild.remove();
  if (seconds > 0) setTimeout(() => item.remove(), 1000 * seconds);
}

const HOLDER = {
  you: "You hold the handle", other: "Another viewer holds the handle", nobody: "Nobody holds the handle",
  none: "No handle to take in this scene", device: "A device moves this hand",
};

export function showHolder(handle) {
  const holder = handle.hand < 0 ? "none" : handle.canMove ? handle.holder : "device";
  const take = element("take");
  element("holding").className = holder;
  element("holder").textContent = HOLDER[holder];
  element("view").classList.toggle("holding", holder === "you");
  take.hidden = holder === "none" || holder === "device";
  take.disabled = holder === "other";
  take.textContent = holder === "you" ? "Give it back" : "Take the handle";
}

export function showHint(handle) {
  const touch = matchMedia("(pointer: coarse)").matches;
  const texts = handle.held
    ? ["Drag: move \u00b7 wheel: depth \u00b7 Shift: turn \u00b7 right drag: orbit",
      "One finger: move \u00b7 two: orbit \u00b7 pinch: depth"]
    : ["Drag the tool to take it \u00b7 drag elsewhere: orbit \u00b7 wheel: zoom",
      "Drag the tool to take it \u00b7 elsewhere: orbit \u00b7 pinch: zoom"];
  element("hint").textContent = handle.hand < 0 ? "Drag: orbit \u00b7 wheel: zoom" : texts[touch ? 1 : 0];
}

export function showLegend(range_m) {
  const milli = range_m >= 1e-3 ? [1e3, "mm"] : [1e6, "\u00b5m"];
  element("range-unit").textContent = milli[1];
  element("range-middle").textContent = short((range_m * milli[0]) / 2);
  element("range-end").textContent = short(range_m * milli[0]);
  element("legend").setAttribute("aria-label",
    `Colours of displacement from 0 to ${short(range_m * milli[0])} ${milli[1]}`);
}
