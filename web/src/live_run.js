// A run that goes on: rows are added at its end.

import { Run } from "./run.js";

const kMostRows = 60000;
const kSameTime = 1e-6; // [s]: the page's own rows have their time rounded

/// Beyond `most` rows every second one of the older half is left out.
export class LiveRun extends Run {
  constructor(description, columns, most = kMostRows) {
    super(description, columns);
    this.grows = true;
    this.most = most;
    this.thinnedUntil = null; // time [s]
    this.stores = [columns[0], ...this.columns].map(({ values }) => values);
    this.count = this.times.length;
    while (this.count > most) this.#thin();
    this.#show();
  }

  /// Adds rows of numbers in the order of the columns, the time first, as far as they are newer than
  /// what is there. Tells how many were added, and how long the pause before the first of them is,
  /// beyond what is usual [s].
  append(numbers) {
    const width = this.stores.length;
    const rows = numbers.length / width;
    let first = 0;
    while (first < rows && !(numbers[first * width] > this.to + kSameTime)) ++first;
    if (first === rows) return { added: 0, missing: 0 };
    const missing = first || !this.count ? 0 : this.#missing(numbers, rows, width);
    this.#reserve(this.count + rows - first);
    for (let row = first; row < rows; ++row, ++this.count)
      for (let c = 0; c < width; ++c) this.stores[c][this.count] = numbers[row * width + c];
    this.#measure(this.count - rows + first);
    while (this.count > this.most) this.#thin();
    this.#show();
    return { added: rows - first, missing };
  }

  #missing(numbers, rows, width) {
    const { times } = this;
    const usual =
      rows > 1
        ? numbers[width] - numbers[0]
        : times.length > 1
          ? this.to - times[times.length - 2]
          : Infinity;
    const pause = numbers[0] - this.to;
    return pause > 2.5 * usual ? pause - usual : 0;
  }

  #reserve(count) {
    if (count <= this.stores[0].length) return;
    this.stores = this.stores.map((store) => {
      const larger = new Float64Array(Math.max(2 * count, 4096));
      larger.set(store.subarray(0, this.count));
      return larger;
    });
  }

  /// What is known of a column, with its rows from `first` on.
  #measure(first) {
    this.columns.forEach((column, c) => {
      const store = this.stores[c + 1];
      for (let row = first; row < this.count; ++row) {
        const value = store[row];
        if (Math.abs(value) > column.greatest) column.greatest = Math.abs(value);
        if (column.step === 1 && !Number.isInteger(value) && !Number.isNaN(value)) column.step = 0;
      }
    });
  }

  #thin() {
    const half = this.count >> 1;
    this.thinnedUntil = this.stores[0][half - 1];
    const kept = (half + 1) >> 1;
    for (const store of this.stores) {
      for (let row = 0; row < kept; ++row) store[row] = store[2 * row];
      store.copyWithin(kept, half, this.count);
    }
    this.count -= half - kept;
  }

  #show() {
    const [times, ...values] = this.stores.map((store) => store.subarray(0, this.count));
    this.times = times;
    this.columns.forEach((column, c) => (column.values = values[c]));
  }

  rowsFor(from, to) {
    return [Math.max(this.rowAt(from), 0), Math.min(this.rowAt(to) + 2, this.times.length)];
  }
}
