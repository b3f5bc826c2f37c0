// Tables whose headers sort: the page says in data-sort whether a column holds numbers or text.

const NUMBER = /[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?/i;

const isEmpty = (text) => text === "" || text === "-" || text === "nan";

/// The first number of a cell: "<= 0.12" and "1.50 (1.31 to 1.72)" sort by 0.12 and 1.50.
function numberIn(text) {
  const found = text.match(NUMBER);
  return found ? Number(found[0]) : NaN;
}

function compareCells(a, b, kind) {
  if (kind === "number") return numberIn(a) - numberIn(b);
  return a.localeCompare(b, "en", { numeric: true });
}

/// Cells without a value stay at the end, whichever way a column is sorted; equal rows keep their order.
function sortRows(table, column, kind, descending) {
  const body = table.tBodies[0];
  const keyed = Array.from(body.rows, (row) => ({ row, text: row.cells[column].textContent.trim() }));
  const full = keyed.filter((k) => !isEmpty(k.text)), empty = keyed.filter((k) => isEmpty(k.text));
  full.sort((a, b) => (descending ? -1 : 1) * compareCells(a.text, b.text, kind));
  body.append(...[...full, ...empty].map((k) => k.row));
}

function makeSortable(table) {
  const headers = Array.from(table.tHead.rows[0].cells);
  headers.forEach((header, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "sort";
    button.append(...header.childNodes);
    header.append(button);
    button.addEventListener("click", () => {
      const descending = header.getAttribute("aria-sort") === "ascending";
      for (const other of headers) other.removeAttribute("aria-sort");
      header.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sortRows(table, column, header.dataset.sort, descending);
    });
  });
}

export function makeTablesSortable() {
  for (const table of document.querySelectorAll("table.sortable"))
    if (table.tBodies[0] && table.tBodies[0].rows.length > 1) makeSortable(table);
}
