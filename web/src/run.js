// A run as the page holds it: named columns over time.

import { decodePageData } from "./page_data.js";

export class Run {
  static async load(description) {
    const source = document.getElementById(description.data);
    if (!source) throw new Error(`the page has no element “${description.data}”`);
    const { columns } = await decodePageData(source.textContent).catch((cause) => {
      const what = `the data in “${description.data}” cannot be unpacked`;
      throw new Error(`${what}; make the report again`, { cause });
    });
    if (columns.length !== description.columns.length)
      throw new Error(
        `${columns.length} columns of data for ${description.columns.length} names of columns`,
      );
    return new this(description, columns);
  }

  constructor(description, columns) {
    this.description = description;
    this.times = columns[0].values;
    this.columns = description.columns.slice(1).map((about, i) => ({
      ...about,
      path: about.path ?? about.name,
      element: about.element ?? "",
      unit: about.unit ?? "",
      ...columns[i + 1],
      greatest: sizeOf(columns[i + 1].values),
    }));
    this.byName = new Map(this.columns.map((column) => [column.name, column]));
    this.bits = Math.min(...this.columns.map((column) => column.bits), 24);
  }

  get title() {
    return this.description.title;
  }

  get from() {
    return this.times.length ? this.times[0] : 0;
  }

  get to() {
    return this.times.length ? this.times[this.times.length - 1] : 0;
  }

  /// Paths in the order of the columns, each with its columns.
  paths() {
    return (this.byPath ??= this.#grouped());
  }

  #grouped() {
    const paths = new Map();
    for (const column of this.columns) {
      if (!paths.has(column.path)) paths.set(column.path, []);
      paths.get(column.path).push(column);
    }
    return paths;
  }

  /// The last row at or before t; −1 before the first.
  rowAt(t) {
    let low = 0;
    let high = this.times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= t) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  /// The rows that a plot from one time to another needs: [first, one past the last].
  rowsFor() {
    return [0, this.times.length];
  }

  /// As recorded at or before t.
  valueAt(column, t) {
    const row = Math.max(this.rowAt(t), 0);
    return row < column.values.length ? column.values[row] : NaN;
  }

  /// Between the rows before and after t; an angle that jumps by a turn is held.
  between(column, t) {
    const row = Math.max(this.rowAt(t), 0);
    const here = column.values[row] ?? 0;
    const next = column.values[Math.min(row + 1, column.values.length - 1)] ?? here;
    const span = this.times[row + 1] - this.times[row];
    if (!(span > 0) || !(Math.abs(next - here) <= Math.PI)) return here;
    return here + (next - here) * Math.min(Math.max((t - this.times[row]) / span, 0), 1);
  }
}

function sizeOf(values) {
  let greatest = 0;
  for (const v of values) if (Math.abs(v) > greatest) greatest = Math.abs(v);
  return greatest;
}
