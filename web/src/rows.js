// Rows of numbers, as the topic /pliant/rows has them: a float64[] in little-endian CDR.

const kHead = 12; // encapsulation, count, and what aligns the numbers to 8 bytes after the first 4

/// The numbers of rows of `columns` numbers each, row after row.
export function decodeRows(data, columns) {
  const view = ArrayBuffer.isView(data)
    ? new DataView(data.buffer, data.byteOffset, data.byteLength)
    : new DataView(data);
  const count = view.byteLength < kHead ? -1 : view.getUint32(4, true);
  if (count < 0 || view.byteLength < kHead + (count ? 8 * count : 0))
    throw new Error(`rows are cut off: ${view.byteLength} bytes`);
  if (count % columns)
    throw new Error(`${count} numbers make no rows of ${columns}; reload the page`);
  const begin = view.byteOffset + kHead;
  return new Float64Array(view.buffer.slice(begin, begin + 8 * count));
}
