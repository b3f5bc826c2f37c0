// A heat map's cells by keyboard, click and touch: what a cell's title says stands in a line beneath the map.

const STEPS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };
const HINT = "Click or touch a cell, or move between cells with the arrow keys: its details appear here.";

export function makeHeatMapsReadable() {
  for (const table of document.querySelectorAll("table.heat")) makeReadable(table);
}

function makeReadable(table) {
  const rows = [...table.querySelectorAll("tr")]
    .map((row) => [...row.querySelectorAll("td")])
    .filter((cells) => cells.length > 0);
  const first = table.querySelector("td:not(.none)");
  if (!first) return;
  const read = document.createElement("p");
  read.className = "heatread";
  read.setAttribute("role", "status");
  read.textContent = HINT;
  table.parentElement.after(read);
  table.setAttribute("role", "grid");

  let current = first; // the one cell that the Tab key comes to
  current.tabIndex = 0;
  table.addEventListener("focusin", ({ target }) => {
    if (target.tagName !== "TD") return;
    current.tabIndex = -1;
    current = target;
    current.tabIndex = 0;
    read.textContent = current.title;
  });
  table.addEventListener("click", ({ target }) => {
    const cell = target.closest("td:not(.none)");
    if (!cell) return;
    cell.tabIndex = 0;
    cell.focus();
  });
  table.addEventListener("keydown", (event) => {
    const step = STEPS[event.key];
    if (!step || event.target.tagName !== "TD") return;
    event.preventDefault();
    const next = nextCell(rows, event.target, step);
    if (!next) return;
    next.tabIndex = 0;
    next.focus();
  });
}

/** The next cell that way which holds something. */
function nextCell(rows, cell, [down, right]) {
  let row = rows.findIndex((cells) => cells.includes(cell));
  let column = rows[row].indexOf(cell);
  for (;;) {
    row += down;
    column += right;
    const next = rows[row]?.[column];
    if (!next || !next.classList.contains("none")) return next;
  }
}
