// Which columns stand in which plot: a list of plots, each a list of names of columns.

const kUnitsOfAPlot = 2; // one axis on the left, one on the right
const kFirstPlots = 3;

/// The plots that the page asks for, as lists of paths, or the first paths of the run.
export function firstLayout(run, wanted) {
  const paths = run.paths();
  const lists = wanted ?? [...paths.keys()].slice(0, kFirstPlots).map((path) => [path]);
  return tidy(lists.map((list) => list.flatMap((path) => (paths.get(path) ?? []).map(nameOf))));
}

/// What another run has of a layout; all of its own first plots if it has nothing of it.
export function carriedOver(layout, run, wanted) {
  const kept = tidy(layout.map((plot) => plot.filter((name) => run.byName.has(name))));
  return kept.length ? kept : firstLayout(run, wanted);
}

export function plotOf(layout, name) {
  return layout.findIndex((plot) => plot.includes(name));
}

export function without(layout, names) {
  return tidy(layout.map((plot) => plot.filter((name) => !names.includes(name))));
}

/// With the names in plot `index`, or in a plot of their own after the last.
export function withNames(layout, names, index) {
  const rest = layout.map((plot) => plot.filter((name) => !names.includes(name)));
  if (index >= 0 && index < rest.length) rest[index] = [...rest[index], ...names];
  else rest.push(names);
  return tidy(rest);
}

export function unitsOf(run, names) {
  return [...new Set(names.map((name) => run.byName.get(name).unit))];
}

/// Whether a plot can take the names: it has an axis for two units.
export function takes(run, plot, names) {
  return unitsOf(run, [...plot, ...names]).length <= kUnitsOfAPlot;
}

function tidy(layout) {
  return layout.filter((plot) => plot.length);
}

function nameOf(column) {
  return column.name;
}
