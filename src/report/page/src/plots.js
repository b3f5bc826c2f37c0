// A figure's chart drawn by uPlot from the numbers in the page.
import uPlot from "uplot";
import css from "uplot/dist/uPlot.min.css";
import { axisOf, scaleOf } from "./axes.js";
import { drawFloor, drawLevels, drawMarks, drawSpans } from "./decoration.js";
import { makeLegend } from "./legend.js";
import { attachReading } from "./reading.js";
import { colourOf, inkOf } from "./colours.js";
import { addDrawn, drawForPrint } from "./paper.js";

const ascends = (values) => values.every((v, i) => i === 0 || v > values[i - 1]);

/// A line in the order of its points: a ladder may step back in run time, which aligned data cannot say.
function pathInOrder(x, y) {
  return (u) => {
    const path = new Path2D(), across = (value) => u.valToPos(value, "x", true);
    x.forEach((value, i) => path.lineTo(across(value), u.valToPos(y[i], "y", true)));
    const area = new Path2D(path), bottom = u.bbox.top + u.bbox.height;
    area.lineTo(across(x[x.length - 1]), bottom);
    area.lineTo(across(x[0]), bottom);
    return { stroke: path, fill: area, clip: null, band: null, gaps: null, flags: 0 };
  };
}

function seriesOf(one) {
  const marked = one.mark === "points" || one.mark === "line-points";
  const stroke = () => colourOf(one);
  const out = {
    label: one.name,
    stroke,
    width: one.mark === "points" ? 0 : one.width || (one.colour === "ink" ? 2.2 : 1.6),
    spanGaps: true,
    points: { show: marked, size: 6, width: 0, fill: stroke },
  };
  if (one.mark === "dashed") out.dash = [6, 5];
  if (one.mark === "points") out.paths = () => null;
  else if (!ascends(one.x)) out.paths = pathInOrder(one.x, one.y);
  if (one.mark === "area") out.fill = () => colourOf(one) + "40";
  return out;
}

/// The empty holder of a chart, in place of the note on where the values are without a script.
function makeHolder(figure) {
  const holder = document.createElement("div");
  holder.className = "live";
  figure.querySelector(".values").replaceWith(holder);
}

function drawChart(figure) {
  const data = JSON.parse(figure.querySelector("script.plot-data").textContent);
  const holder = figure.querySelector(".live");
  holder.tabIndex = 0;
  holder.setAttribute("role", "group");
  holder.setAttribute("aria-label", `${data.y_label} against ${data.x_label}: arrow keys read values, plus ` +
    "and minus zoom, 0 shows all");

  const height = () => Math.min(data.height, Math.max(260, Math.round(0.75 * holder.clientWidth)));
  const options = {
    width: holder.clientWidth,
    height: height(),
    title: data.title || undefined,
    legend: { show: false },
    cursor: { drag: { x: true, y: true, uni: 30 }, points: { show: false } },
    scales: { x: scaleOf(data, "x"), y: scaleOf(data, "y") },
    axes: [axisOf(data, "x", inkOf), axisOf(data, "y", inkOf)],
    series: [{}, ...data.series.map((one) => seriesOf(one))],
    hooks: { drawClear: [(u) => drawFloor(u, data), (u) => drawSpans(u, data)],
      drawAxes: [(u) => drawLevels(u, data)], draw: [(u) => drawMarks(u, data)] },
  };
  const aligned = uPlot.join(data.series.map((one) => {
    const order = one.x.map((_, i) => i).sort((a, b) => one.x[a] - one.x[b]);
    return [order.map((i) => one.x[i]), order.map((i) => one.y[i])];
  }));
  const plot = new uPlot(options, aligned, holder);
  addDrawn(plot);
  holder.after(makeLegend(plot, data));
  attachReading(plot, data, holder);
  new ResizeObserver(() => {
    if (holder.clientWidth > 0 && holder.clientWidth !== plot.width)
      plot.setSize({ width: holder.clientWidth, height: height() });
  }).observe(holder);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plot.redraw());
}

/// Each is drawn when it is first seen, or printed: one in a closed <details> has no size before.
export function drawCharts() {
  const waiting = new Set(document.querySelectorAll("figure.chart"));
  if (waiting.size === 0) return;
  const style = document.createElement("style");
  style.textContent = css;
  document.head.prepend(style);
  const draw = (figure) => {
    observer.unobserve(figure);
    if (waiting.delete(figure)) drawChart(figure);
  };
  const observer = new IntersectionObserver(
    (entries) => entries.filter((entry) => entry.isIntersecting).forEach((entry) => draw(entry.target)),
    { rootMargin: "300px" });
  for (const figure of waiting) {
    makeHolder(figure);
    observer.observe(figure);
  }
  drawForPrint(() => [...waiting].filter((one) => !one.closest("details:not([open])")).forEach(draw));
}
