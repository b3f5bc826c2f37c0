// What stands in a plot beside its lines: the floor, levels, rings and names.
import { colourOf, pageColour } from "./colours.js";

const LEVEL = "#d1495b", px = devicePixelRatio;

function clipped(u, draw) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(ctx, bbox);
  ctx.restore();
}

/// Shades errors below the reference's own.
export function drawFloor(u, data) {
  if (data.floor_y === null || data.floor_y <= u.scales.y.min) return;
  clipped(u, (ctx, box) => {
    const top = Math.max(box.top, u.valToPos(data.floor_y, "y", true));
    ctx.fillStyle = pageColour("tint");
    ctx.fillRect(box.left, top, box.width, box.top + box.height - top);
  });
}

/// Draws limits over the grid, which often has a line there, too.
export function drawLevels(u, data) {
  clipped(u, (ctx, box) => {
    ctx.strokeStyle = LEVEL;
    ctx.lineWidth = 1.2 * px;
    ctx.setLineDash([6 * px, 5 * px]);
    for (const level of data.levels) {
      const y = u.valToPos(level.y, "y", true);
      ctx.beginPath();
      ctx.moveTo(box.left, y);
      ctx.lineTo(box.left + box.width, y);
      ctx.stroke();
    }
  });
}

/// Bands for the phases of a motion, every other one tinted, with their names along the upper edge.
export function drawSpans(u, data) {
  clipped(u, (ctx, box) => {
    const across = (value) => u.valToPos(value, "x", true);
    ctx.font = `${11 * px}px system-ui, sans-serif`;
    ctx.textAlign = "center";
    data.spans.forEach((span, i) => {
      const left = Math.max(box.left, across(span.from));
      const right = Math.min(box.left + box.width, across(span.to));
      if (right <= left) return;
      ctx.fillStyle = pageColour("tint");
      if (i % 2 === 1) ctx.fillRect(left, box.top, right - left, box.height);
      ctx.fillStyle = pageColour("quiet");
      if (ctx.measureText(span.label).width < right - left)
        ctx.fillText(span.label, (left + right) / 2, box.top + 13 * px);
    });
  });
}

/// Text on a halo of the page's colour.  A name that would lie over another is left out.
function writer(ctx) {
  const taken = [];
  ctx.font = `${11 * px}px system-ui, sans-serif`;
  ctx.lineWidth = 3 * px;
  ctx.lineJoin = "round";
  return (text, x, y, colour, align) => {
    const width = ctx.measureText(text).width, left = align === "right" ? x - width : x, tall = 12 * px;
    if (taken.some((t) => left < t.right && left + width > t.left && Math.abs(y - t.y) < tall)) return;
    taken.push({ left, right: left + width, y });
    ctx.textAlign = align;
    ctx.strokeStyle = pageColour("page");
    ctx.fillStyle = colour;
    ctx.strokeText(text, x, y);
    ctx.fillText(text, x, y);
  };
}

function drawRing(ctx, x, y) {
  ctx.fillStyle = pageColour("page");
  ctx.beginPath();
  ctx.arc(x, y, 1.8 * px, 0, 2 * Math.PI);
  ctx.fill();
}

/// Opens the points that the reference does not resolve, and writes names.
export function drawMarks(u, data) {
  clipped(u, (ctx, box) => {
    const write = writer(ctx), gap = 7 * px, right = box.left + box.width;
    const at = (one, i) => [u.valToPos(one.x[i], "x", true), u.valToPos(one.y[i], "y", true)];
    const shown = data.series.filter((one, s) => u.series[s + 1].show);
    for (const one of shown)
      (one.hollow || []).forEach((hollow, i) => hollow && drawRing(ctx, ...at(one, i)));
    for (const level of data.levels)
      write(level.label, right - gap, u.valToPos(level.y, "y", true) + 14 * px, LEVEL, "right");
    if (data.floor_y !== null && data.floor_y > u.scales.y.min) {
      const y = Math.max(box.top, u.valToPos(data.floor_y, "y", true)) + 14 * px;
      write(data.floor_label, box.left + gap, y, pageColour("quiet"), "left");
    }
    for (const one of shown)
      (one.labels || []).forEach((label, i) => {
        const [x, y] = at(one, i), width = ctx.measureText(label).width;
        const toLeft = one.labels_below ? x - gap - width > box.left : x + gap + width > right;
        if (label)
          write(label, toLeft ? x - gap : x + gap, y + (one.labels_below ? 12 : -5) * px, colourOf(one),
            toLeft ? "right" : "left");
      });
  });
}
