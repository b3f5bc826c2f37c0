// The key of a plot: series by what they are called, since the ladders of a family share one entry.

/// Returns name and indices of series.
export function keyOf(data) {
  const groups = new Map();
  data.series.forEach((one, s) => {
    const name = one.group || one.name;
    if (!name) return;
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push(s);
  });
  return groups;
}
