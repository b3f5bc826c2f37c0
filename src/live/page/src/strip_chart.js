// Force and torque of the last seconds, as two curves over simulated time.
import { niceAbove, short, unitFor } from "./numbers.js";

export const SPAN_S = 10;
const SAMPLE = 7, PERIOD_MS = 50, LEFT_PX = 44, RIGHT_PX = 8, TOP_PX = 16, GAP_PX = 30, BOTTOM_PX = 18;
const STEPS = [1, 2, 5, 10];  // of ranges: few, so that they seldom jump
const LEAST = { force: 0.01, torque: 1e-4 };  // ranges [N, N m]

/// The last SPAN_S seconds of one hand: time, |force|, its components, |torque|, its components.
class Samples {
  constructor() {
    this.rows = [];
    this.first = 0;
  }
  add(time_s, samples) {
    for (let at = 0; at < samples.length; at += SAMPLE) {
      const [dt, fx, fy, fz, tx, ty, tz] = samples.subarray(at, at + SAMPLE);
      this.rows.push([time_s + dt, Math.hypot(fx, fy, fz), fx, fy, fz, Math.hypot(tx, ty, tz), tx, ty, tz]);
    }
    while (this.first < this.rows.length && this.rows[this.first][0] < time_s - SPAN_S) ++this.first;
    if (this.first > 4000) this.rows.splice(0, this.first), this.first = 0;
  }
  /// The largest magnitude in column `at`, over what is shown.
  peak(at) {
    let most = 0;
    for (let i = this.first; i < this.rows.length; ++i) most = Math.max(most, this.rows[i][at]);
    return most;
  }
}

export class StripChart {
  constructor(canvas) {
    this.canvas = canvas;
    // drawn by the processor: long thin curves are slow on a graphics card, very slow on an emulated one
    this.pen = canvas.getContext("2d", { willReadFrequently: true });
    this.components = false;
    this.drawn_ms = -Infinity;
    this.reset(1);
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /// Begins anew; a scene without hands has one empty chart.
  reset(hands) {
    this.hands = Array.from({ length: Math.max(1, hands) }, () => new Samples());
    this.hand = 0;
    this.time_s = 0;
  }

  show(hand) {
    this.hand = hand;
    this.draw();
  }

  add(frame) {
    if (frame.time_s < this.time_s) this.reset(this.hands.length);  // it began anew
    this.time_s = frame.time_s;
    frame.samples.forEach((samples, hand) => this.hands[hand].add(frame.time_s, samples));
    const now = performance.now();
    if (now - this.drawn_ms < PERIOD_MS) return;
    this.drawn_ms = now;
    this.draw();
  }

  get shown() { return this.hands[Math.max(0, this.hand)]; }

  /// Ranges of both curves: the ends of their axes.
  ranges() {
    const end = (least, column) => niceAbove(Math.max(least, this.shown.peak(column)), STEPS);
    return { force_n: end(LEAST.force, 1), torque_n_m: end(LEAST.torque, 5) };
  }

  summary() {
    return `the last ${SPAN_S} s: force at most ${short(this.shown.peak(1))} N, torque at most ` +
      `${short(this.shown.peak(5))} N m`;
  }

  draw() {
    const { canvas } = this, { clientWidth: width, clientHeight: height } = canvas;
    if (width === 0 || height === 0) return;
    const ratio = Math.min(2, devicePixelRatio || 1), { pen } = this;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    const style = getComputedStyle(canvas), colour = (name) => style.getPropertyValue(`--${name}`).trim();
    const both = height - TOP_PX - GAP_PX - BOTTOM_PX, { force_n, torque_n_m } = this.ranges();
    const frame = { pen, colour, left: LEFT_PX, right: width - RIGHT_PX };
    this.drawCurves(frame, { name: "force", unit: "N", column: 1, most: force_n,
      top: TOP_PX, size: 0.66 * both });
    this.drawCurves(frame, { name: "torque", unit: "N m", column: 5, most: torque_n_m,
      top: TOP_PX + 0.66 * both + GAP_PX, size: 0.34 * both });
    pen.fillStyle = colour("quiet");
    pen.textBaseline = "bottom";
    for (const [text, at, align] of [[`-${SPAN_S} s`, frame.left, "left"], ["now", frame.right, "right"],
      [`-${SPAN_S / 2} s`, (frame.left + frame.right) / 2, "center"]]) {
      pen.textAlign = align;
      pen.fillText(text, at, height - 2);
    }
  }

  drawCurves({ pen, colour, left, right }, { name, unit, column, most, top, size }) {
    const low = this.components ? -most : 0, shown = unitFor(most, unit);
    const x = (time_s) => right + ((time_s - this.time_s) / SPAN_S) * (right - left);
    const y = (value) => top + size * (1 - (value - low) / (most - low));
    pen.lineWidth = 1;
    pen.strokeStyle = colour("line");
    pen.fillStyle = colour("quiet");
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const value of this.components ? [-most, 0, most] : [0, most / 2, most]) {
      const at = Math.round(y(value)) + 0.5;
      pen.beginPath();
      pen.moveTo(left, at);
      pen.lineTo(right, at);
      pen.stroke();
      pen.fillText(short(value / shown.scale), left - 6, at);
    }
    pen.textAlign = "left";
    pen.textBaseline = "bottom";
    pen.fillStyle = colour("ink");
    pen.fillText(`${name} [${shown.unit}]`, left, top - 3);
    const curves = [{ at: column, ink: colour(name), width: 1.8 }];
    if (this.components)
      ["x", "y", "z"].forEach((axis, k) =>
        curves.unshift({ at: column + 1 + k, ink: colour(`axis-${axis}`), width: 1 }));
    for (const { at, ink, width } of curves) {
      pen.strokeStyle = ink;
      pen.lineWidth = width;
      pen.beginPath();
      const { rows, first } = this.shown;
      for (let i = first; i < rows.length; ++i)
        pen.lineTo(Math.max(left, x(rows[i][0])), y(rows[i][at]));
      pen.stroke();
    }
  }
}
