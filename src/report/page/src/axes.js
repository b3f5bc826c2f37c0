// Scales and axes of a plot.
import { pageColour } from "./colours.js";
import { shortNumber } from "./numbers.js";

/// Room around the data, as a share of its range (of its logarithm on a logarithmic axis).
const ROOM = { x: 0.04, y: 0.07 };

/// The shaded floor is shown where it is not far below the data.
function withFloor(data, name, low) {
  return name === "y" && data.log_y && data.floor_y > low / 30 ? Math.min(low, data.floor_y / 2.5) : low;
}

function withLevels(data, name, low, high) {
  if (name !== "y") return high;
  const reach = 3 * Math.max(Math.abs(low), Math.abs(high));
  return Math.max(high, ...data.levels.map((level) => level.y).filter((y) => Math.abs(y) <= reach));
}

export function fullRange(data, name) {
  const values = data.series.flatMap((one) => one[name]);
  let low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
  high = withLevels(data, name, low, high);
  low = withFloor(data, name, low);
  if (data[`log_${name}`]) {
    const room = Math.max(0.02, ROOM[name] * Math.log10(high / low));
    return [low * 10 ** -room, high * 10 ** room];
  }
  const room = (high - low || Math.abs(high) || 1) * ROOM[name];
  const names = data.spans.length > 0 ? 2 : 1;  // of the phases, above the curves
  return name === "x" ? [low, high + (high > low ? 0 : room)] : [low - room, high + names * room];
}

/// The whole range of the data until the reader zooms: a series that is switched off moves no other.
export function scaleOf(data, name) {
  const all = fullRange(data, name);
  const range = (u, low, high) => {
    const x = u.data[0];
    const zoomed = name === "x" && high > low && (low > x[0] || high < x[x.length - 1]);
    return zoomed ? [low, high] : all;
  };
  return { time: false, distr: data[`log_${name}`] ? 3 : 1, range };
}

/// Ticks of a logarithmic axis: decades, or 1, 2, 5 of each where there is room, or even steps within one.
function logTicks(low, high, most) {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high));
  const ticks = (multiples, every) => {
    const out = [];
    for (let decade = first; decade <= last; ++decade)
      if (decade % every === 0) out.push(...multiples.map((m) => Number(`${m}e${decade}`)));
    return out.filter((tick) => tick >= low && tick <= high);
  };
  for (const multiples of [[1, 2, 3, 4, 5, 6, 7, 8, 9], [1, 2, 5], [1]]) {
    const found = ticks(multiples, 1);
    if (found.length <= most && found.length >= 2) return found;
  }
  const found = ticks([1], Math.max(1, Math.ceil((last - first) / most)));
  return found.length >= 2 ? found : evenTicks(low, high, most);
}

function evenTicks(low, high, most) {
  const rough = (high - low) / Math.max(2, most), size = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * size).find((one) => one >= rough);
  const out = [];
  for (let i = Math.ceil(low / step); i * step <= high; ++i) out.push(i * step);
  return out;
}

export function axisOf(data, name, ink) {
  const space = name === "x" ? 64 : 34, margin = name === "x" ? 80 : 70;
  const most = (u) => Math.max(2, Math.floor(((name === "x" ? u.width : u.height) - margin) / space));
  const log = data[`log_${name}`] && {
    filter: (u, splits) => splits,
    splits: (u, axis, low, high) => logTicks(low, high, most(u)),
  };
  return {
    ...log,
    label: data[`${name}_label`],
    labelSize: 24,
    labelFont: "13px system-ui, sans-serif",
    font: "12px system-ui, sans-serif",
    size: name === "y" ? 62 : 40,
    space,
    stroke: ink,
    grid: { stroke: () => pageColour("line"), width: 1 },
    ticks: { stroke: () => pageColour("line"), width: 1, size: 5 },
    values: (u, splits) => splits.map((v) => (v === null ? "" : shortNumber(v, 4))),
  };
}
