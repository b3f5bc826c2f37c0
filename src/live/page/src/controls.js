// Buttons and sliders.
import { short, withUnit } from "./numbers.js";
import { element, notice } from "./panel.js";

/// Positions of a slider.
const STEPS = 200;

const toShare = ({ min, max, logarithmic }, value) =>
  logarithmic ? Math.log(value / min) / Math.log(max / min) : (value - min) / (max - min);
const toValue = ({ min, max, logarithmic }, share) =>
  logarithmic ? min * (max / min) ** share : min + share * (max - min);

function makeSlider(about, send) {
  const label = document.createElement("label"), name = document.createElement("span");
  const output = document.createElement("output"), input = document.createElement("input");
  name.textContent = about.label;
  Object.assign(input, { type: "range", min: 0, max: STEPS, step: 1 });
  input.setAttribute("aria-label", about.label);
  const say = (value) => {
    output.textContent = withUnit(value, about.unit);
    input.setAttribute("aria-valuetext", output.textContent);
  };
  const chosen = () => Number(toValue(about, input.value / STEPS).toPrecision(3));
  input.addEventListener("input", () => say(chosen()));
  input.addEventListener("change", () => send({ type: "set", key: about.key, value:
    Math.min(about.max, Math.max(about.min, chosen())) }));
  label.append(name, output, input);
  label.title = about.key;
  return { label, show(value) {
    if (input.matches(":active")) return;  // it is being moved
    input.value = Math.round(STEPS * Math.min(1, Math.max(0, toShare(about, value))));
    say(value);
  } };
}

export class Controls {
  constructor(send) {
    this.send = send;
    this.keys = "";
    this.running = true;
    this.recording = false;
    element("pause").addEventListener("click", () => this.pause());
    element("reset").addEventListener("click", () => send({ type: "reset" }));
    element("record").addEventListener("click", () => send({ type: "record", on: !this.recording }));
  }

  pause() {
    this.send({ type: "pause", on: this.running });
  }

  /// The sliders of a scene; one that has the focus keeps it while their keys stay the same.
  setSliders(sliders) {
    const keys = JSON.stringify(sliders.map(({ value, ...rest }) => rest));
    if (keys !== this.keys) {
      this.sliders = sliders.map((one) => makeSlider(one, this.send));
      element("sliders").replaceChildren(...this.sliders.map((one) => one.label));
      this.keys = keys;
    }
    this.sliders.forEach((one, k) => one.show(sliders[k].value));
    element("settings").hidden = sliders.length === 0;
  }

  /// Another viewer's settings can be seen, not changed.
  allow(mine) {
    for (const id of ["pause", "reset", "record"]) element(id).disabled = !mine;
    for (const input of element("sliders").querySelectorAll("input")) input.disabled = !mine;
  }

  show({ running, recording }) {
    this.running = running;
    this.recording = Boolean(recording);
    element("pause").textContent = running ? "Pause" : "Continue";
    element("pause").setAttribute("aria-pressed", String(!running));
    element("record").textContent = recording ? "Stop recording" : "Record";
    element("record").setAttribute("aria-pressed", String(this.recording));
    const line = element("recording");
    if (recording) {
      line.hidden = false;
      line.textContent = `Recording into ${recording.folder}, ${recording.since_s.toFixed(0)} s`;
    }
  }

  recorded({ folder, duration_s, replay }) {
    const line = element("recording"), command = document.createElement("code");
    command.textContent = replay;
    line.hidden = false;
    line.replaceChildren(`Recorded ${short(duration_s)} s into ${folder}. Replay: `, command);
    notice("info", `recorded ${short(duration_s)} s into ${folder}`);
  }
}
