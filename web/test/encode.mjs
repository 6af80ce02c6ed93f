// The packing of analysis/page_data.h with 24 bits, for pages made up by tests.

import { deflateSync } from "node:zlib";

const kModulus = 2 ** 24;
const kTop = kModulus - 2;

function codesOf(values) {
  const finite = values.filter(Number.isFinite);
  const least = finite.length ? Math.min(...finite) : 0;
  const greatest = finite.length ? Math.max(...finite) : 0;
  const whole = finite.every(Number.isInteger) && greatest - least <= kTop;
  const half = whole ? 0.5 : (greatest / 2 - least / 2) / kTop;
  const code = (v) =>
    half > 0 ? Math.min(Math.max(Math.round((v / 2 - least / 2) / half), 0), kTop) : 0;
  const codes = values.map((v) => (Number.isFinite(v) ? code(v) : kTop + 1));
  return { offset: least, step: 2 * half, codes };
}

/// Differences of the first order, folded to 0, −1, 1, −2 … → 0, 1, 2, 3 ….
function residualsOf(codes, modulus) {
  return codes.map((code, i) => {
    let left = code - (i ? codes[i - 1] : 0);
    if (left >= modulus / 2) left -= modulus;
    if (left < -modulus / 2) left += modulus;
    return left < 0 ? -2 * left - 1 : 2 * left;
  });
}

export function encodePageData(columns) {
  const rows = columns[0].length;
  const head = Buffer.alloc(8 + 24 * columns.length);
  head.writeUInt32LE(rows, 0);
  head.writeUInt32LE(columns.length, 4);
  const parts = [head];
  columns.forEach((values, c) => {
    const time = c === 0;
    const { offset, step, codes } = time
      ? { offset: 0, step: 1e-9, codes: values.map((t) => Math.round(t * 1e9)) }
      : codesOf(values);
    const bytes = time ? 8 : 3;
    const residuals = residualsOf(codes, time ? Infinity : kModulus);
    head.writeUInt32LE(bytes, 8 + 24 * c);
    head.writeUInt32LE(1, 12 + 24 * c);
    head.writeDoubleLE(offset, 16 + 24 * c);
    head.writeDoubleLE(step, 24 + 24 * c);
    for (let plane = 0; plane < bytes; ++plane)
      parts.push(Buffer.from(residuals.map((r) => Math.floor(r / 256 ** plane) % 256)));
  });
  return deflateSync(Buffer.concat(parts)).toString("base64");
}
