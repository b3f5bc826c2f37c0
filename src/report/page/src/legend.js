// The key of a plot as buttons: one switches all series of its name.
import { fullRange } from "./axes.js";
import { cssColourOf } from "./colours.js";
import { keyOf } from "./key.js";
import { savePicture } from "./paper.js";

function resetButton(plot, data) {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "reset";
  button.textContent = "show all";
  button.title = "drag in the plot to zoom; a double click or 0 shows all again";
  button.hidden = true;
  plot.showAll = () => {
    const x = plot.data[0];
    plot.setScale("x", { min: x[0], max: x[x.length - 1] });
  };
  button.addEventListener("click", plot.showAll);
  const isAll = (name) => {
    const [low, high] = fullRange(data, name), { min, max } = plot.scales[name];
    return min <= low && max >= high;
  };
  (plot.hooks.setScale ||= []).push(() => { button.hidden = isAll("x") && isAll("y"); });
  return button;
}

function saveButton(plot, data) {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "save";
  button.textContent = "save PNG";
  button.title = "save this chart, as it is zoomed, as a picture";
  button.addEventListener("click", () => savePicture(plot, data));
  return button;
}

export function makeLegend(plot, data) {
  const legend = document.createElement("div");
  legend.className = "legend";
  for (const [name, members] of keyOf(data)) {
    const button = document.createElement("button"), swatch = document.createElement("i");
    button.type = "button";
    button.setAttribute("aria-pressed", "true");
    button.title = `switch ${name} on or off`;
    const first = data.series[members[0]];
    swatch.style.setProperty("--swatch", cssColourOf(first));
    if (first.mark === "dashed") swatch.className = "dashed";
    button.append(swatch, name);
    button.addEventListener("click", () => {
      const show = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(show));
      plot.batch(() => members.forEach((s) => plot.setSeries(s + 1, { show })));
    });
    legend.append(button);
  }
  legend.append(resetButton(plot, data), saveButton(plot, data));
  return legend;
}
