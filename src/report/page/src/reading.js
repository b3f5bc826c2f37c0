// Values under the pointer or the arrow keys.
import { cssColourOf } from "./colours.js";
import { shortNumber } from "./numbers.js";

const ZOOM = 1.5;

/// Every point that can be read, in the order of its series: where points have notes, only those.
function pointsOf(data) {
  const noted = data.series.some((one) => one.notes);
  const isRead = (one) => (noted ? one.notes : one.mark !== "dashed" && (one.name || one.reading));
  return data.series.flatMap((one, s) =>
    (isRead(one) ? one.x.map((x, i) => ({ s, i, x, y: one.y[i] })) : []));
}

function lineOf(data, point) {
  const one = data.series[point.s];
  const line = document.createElement("div"), swatch = document.createElement("i");
  swatch.style.setProperty("--swatch", cssColourOf(one));
  const name = one.reading || one.name, note = (one.notes && one.notes[point.i]) || "";
  line.append(swatch, `${name}${note ? `, ${note}` : ""}: ${shortNumber(point.y, 4)}`);
  return line;
}

/// The points of one reading: of curves every series at one x, else the one nearest point.
function readingAt(plot, data, points, left, top, curves) {
  const shown = points.filter((p) => plot.series[p.s + 1].show);
  const at = (p) => [plot.valToPos(p.x, "x"), plot.valToPos(p.y, "y")];
  let best = null, least = Infinity;
  for (const p of shown) {
    const [x, y] = at(p), distance = curves ? Math.abs(x - left) : Math.hypot(x - left, y - top);
    if (distance < least) least = distance, best = p;
  }
  if (!best || (!curves && least > 60)) return [];
  if (!curves) return [best];
  const nearest = new Map();
  for (const p of shown) {
    const known = nearest.get(p.s);
    if (!known || Math.abs(p.x - best.x) < Math.abs(known.x - best.x)) nearest.set(p.s, p);
  }
  return [...nearest.values()];
}

function zoom(plot, factor) {
  const around = (name, position, size) => {
    const { min, max, distr } = plot.scales[name], log = distr === 3;
    const to = log ? Math.log10 : (v) => v, from = log ? (v) => 10 ** v : (v) => v;
    const inside = position > 0 && position < size;
    const middle = inside ? to(plot.posToVal(position, name)) : (to(min) + to(max)) / 2;
    const scaled = (value) => from(middle + (to(value) - middle) / factor);
    plot.setScale(name, { min: scaled(min), max: scaled(max) });
  };
  const { left, top } = plot.cursor, { width, height } = plot.over.getBoundingClientRect();
  plot.batch(() => (around("x", left, width), around("y", top, height)));
}

export function attachReading(plot, data, holder) {
  const points = pointsOf(data);
  const curves = data.series.every((one) => one.mark !== "line-points" && one.mark !== "points");
  const tip = document.createElement("div");
  tip.className = "reading";
  tip.hidden = true;
  tip.setAttribute("role", "status");
  plot.over.append(tip);
  const ring = document.createElement("div");
  ring.className = "ring";
  ring.hidden = true;
  plot.over.append(ring);

  const show = (found) => {
    tip.hidden = ring.hidden = found.length === 0;
    if (found.length === 0) return;
    const head = document.createElement("div");
    head.textContent = `${data.x_label}: ${shortNumber(found[0].x, 5)}`;
    tip.replaceChildren(head, ...found.map((p) => lineOf(data, p)));
    const x = plot.valToPos(found[0].x, "x"), y = plot.valToPos(found[0].y, "y");
    ring.hidden = curves;
    ring.style.left = `${x}px`;
    ring.style.top = `${y}px`;
    const width = plot.over.clientWidth, room = width - tip.offsetWidth;
    tip.style.left = `${Math.max(0, x + 14 <= room ? x + 14 : x - 14 - tip.offsetWidth)}px`;
    const below = plot.over.clientHeight - tip.offsetHeight;
    tip.style.top = `${Math.max(0, Math.min(curves ? 8 : y + 10, below))}px`;
  };
  (plot.hooks.setCursor ||= []).push((u) => {
    const { left, top } = u.cursor;
    show(left < 0 ? [] : readingAt(u, data, points, left, top, curves));
  });

  let at = -1;
  const step = (by) => {
    const shown = points.filter((p) => plot.series[p.s + 1].show && (!curves || p.s === points[0].s));
    if (shown.length === 0) return;
    const stride = curves ? Math.max(1, Math.round(shown.length / 100)) : 1;
    at = at < 0 ? (by > 0 ? 0 : shown.length - 1) : Math.min(shown.length - 1, Math.max(0, at + by * stride));
    const p = shown[at];
    plot.setCursor({ left: plot.valToPos(p.x, "x"), top: plot.valToPos(p.y, "y") });
  };
  const keys = { ArrowRight: () => step(1), ArrowLeft: () => step(-1), "+": () => zoom(plot, ZOOM),
    "=": () => zoom(plot, ZOOM), "-": () => zoom(plot, 1 / ZOOM), 0: plot.showAll,
    Escape: () => plot.setCursor({ left: -10, top: -10 }) };
  holder.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    keys[event.key]();
    event.preventDefault();
  });
  holder.addEventListener("blur", () => show([]));
}
