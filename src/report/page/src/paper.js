// Charts on paper: in print, and saved as pictures. Both have the colours of the light page.
import { colourOf, pageColour } from "./colours.js";
import { keyOf } from "./key.js";

const root = document.documentElement;
const drawn = new Set();

async function redraw(plots) {
  for (const plot of plots) plot.redraw(false);
  await null;  // uPlot draws in a microtask
}

/// @param drawAll  draws the charts that the reader has not scrolled to yet
export function drawForPrint(drawAll) {
  addEventListener("beforeprint", () => {
    root.classList.add("on-paper");
    drawAll();
    redraw(drawn);
  });
  addEventListener("afterprint", () => {
    root.classList.remove("on-paper");
    redraw(drawn);
  });
}

export const addDrawn = (plot) => drawn.add(plot);

/// Writes the key in rows beneath the chart, and returns their height.
function writeKey(ctx, plot, data, width, top) {
  const size = 12 * devicePixelRatio, gap = size / 2, swatch = 1.5 * size;
  ctx.font = `${size}px system-ui, sans-serif`;
  ctx.textBaseline = "middle";
  let x = gap, y = top + size;
  for (const [name, members] of keyOf(data)) {
    if (!members.some((s) => plot.series[s + 1].show)) continue;
    const room = swatch + gap + ctx.measureText(name).width;
    if (x > gap && x + room > width) x = gap, y += 1.5 * size;
    const one = data.series[members[0]];
    ctx.strokeStyle = colourOf(one);
    ctx.lineWidth = 2 * devicePixelRatio;
    ctx.setLineDash(one.mark === "dashed" ? [size / 3, size / 4] : []);
    ctx.beginPath();
    ctx.moveTo(x, y);
    ctx.lineTo(x + swatch, y);
    ctx.stroke();
    ctx.fillStyle = pageColour("ink");
    ctx.fillText(name, x + swatch + gap, y);
    x += room + 2 * gap;
  }
  return y + size - top;
}

/// Saves the chart, as it is zoomed, with its key as a PNG file.
export async function savePicture(plot, data) {
  root.classList.add("on-paper");
  await redraw([plot]);
  const chart = plot.ctx.canvas, sheet = document.createElement("canvas"), ctx = sheet.getContext("2d");
  const height = chart.height + writeKey(ctx, plot, data, chart.width, chart.height);
  sheet.width = chart.width;
  sheet.height = height;
  ctx.fillStyle = pageColour("page");
  ctx.fillRect(0, 0, sheet.width, sheet.height);
  ctx.drawImage(chart, 0, 0);
  writeKey(ctx, plot, data, chart.width, chart.height);
  root.classList.remove("on-paper");
  await redraw([plot]);
  const link = document.createElement("a");
  link.href = sheet.toDataURL("image/png");
  link.download = `${(data.title || data.y_label).replace(/[^A-Za-z0-9]+/g, "-").replace(/^-|-$/g, "")}.png`;
  link.click();
}
