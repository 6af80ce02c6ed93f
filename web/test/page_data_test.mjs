// That the page reads what analysis/page_data.cc writes.
//
//   node page_data_test.mjs PAGE_DATA_SAMPLE FOLDER

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";

import { decodePageData } from "../src/page_data.js";
import { encodePageData } from "./encode.mjs";

const [program, folder] = process.argv.slice(2);
rmSync(folder, { recursive: true, force: true });
execFileSync(program, [folder]);

function recorded(name) {
  const bytes = readFileSync(join(folder, `${name}.f64`));
  const numbers = new Float64Array(new Uint8Array(bytes).buffer);
  const [rows, count] = numbers;
  return Array.from({ length: count }, (_, c) => numbers.slice(2 + c * rows, 2 + (c + 1) * rows));
}

function rangeOf(values) {
  const finite = values.filter(Number.isFinite);
  return finite.length ? Math.max(...finite) / 2 - Math.min(...finite) / 2 : 0;
}

for (const bits of [16, 24]) {
  for (const name of ["mixed", "one_row", "no_row", "uneven_time"]) {
    const columns = recorded(`${name}_${bits}`);
    const text = readFileSync(join(folder, `${name}_${bits}.txt`), "utf8");
    const decoded = await decodePageData(text);
    const where = (c, i) => `${name}, ${bits} bits, column ${c}, row ${i}`;
    assert.equal(decoded.rows, columns[0].length);
    assert.equal(decoded.columns.length, columns.length);
    columns.forEach((expected, c) => {
      const { values, step } = decoded.columns[c];
      assert.equal(values.length, expected.length);
      const whole = expected.filter(Number.isFinite).every(Number.isInteger);
      // Half a step, and the rounding of offset + step · code.
      const round =
        4 * Number.EPSILON * Math.max(...expected.filter(Number.isFinite).map(Math.abs), 0);
      const tolerance = c === 0 ? 0.5e-9 : whole && step === 1 ? 0 : step / 2 + round;
      assert.ok(step === 1 || c === 0 || step / 2 <= (rangeOf(expected) / (2 ** bits - 2)) * 1.001);
      expected.forEach((value, i) => {
        if (!Number.isFinite(value)) assert.ok(Number.isNaN(values[i]), where(c, i));
        else
          assert.ok(
            Math.abs(values[i] - value) <= tolerance,
            `${where(c, i)}: ${value} ${values[i]}`,
          );
      });
    });
  }
}

// The generator of the page tests' data writes what C++ writes, as read here.
const sample = recorded("mixed_24").map((column) => Array.from(column));
const ours = await decodePageData(encodePageData(sample));
const theirs = await decodePageData(readFileSync(join(folder, "mixed_24.txt"), "utf8"));
assert.deepEqual(ours, theirs);
console.log("page data: all columns come back");
