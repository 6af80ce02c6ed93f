// The numbers of a run, as analysis/page_data.h packs them.

/// Columns of a text by PageData: {rows, columns: [{values, step, bits}]}, the first being the time.
/// Values are Float64Array, NaN where there is none; each is within step / 2 of what was recorded.
export async function decodePageData(text) {
  const view = new DataView((await inflate(fromBase64(text.trim()))).buffer);
  const rows = view.getUint32(0, true);
  const count = view.getUint32(4, true);
  let body = 8 + 24 * count;
  const columns = [];
  for (let c = 0; c < count; ++c) {
    const head = 8 + 24 * c;
    const bytes = view.getUint32(head, true);
    const codes = decodeCodes(view, body, rows, bytes, view.getUint32(head + 4, true));
    const step = view.getFloat64(head + 16, true);
    if (bytes === 8) toTimes(codes);
    else toValues(codes, 2 ** (8 * bytes) - 1, view.getFloat64(head + 8, true), step);
    columns.push({ values: codes, step, bits: 8 * bytes });
    body += bytes * rows;
  }
  return { rows, columns };
}

function fromBase64(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// Codes of the time stay below 2⁵³ at every order; those of values count modulo 2ⁿ.
function decodeCodes(view, start, rows, bytes, order) {
  const codes = new Float64Array(rows);
  const modulus = bytes < 8 ? 2 ** (8 * bytes) : Infinity;
  for (let i = 0; i < rows; ++i) {
    let folded = 0;
    for (let k = bytes; k-- > 0;) folded = 256 * folded + view.getUint8(start + k * rows + i);
    codes[i] = folded % 2 ? -(folded + 1) / 2 : folded / 2;
  }
  for (let k = 0; k < order; ++k)
    for (let i = 1; i < rows; ++i) codes[i] = (codes[i] + codes[i - 1]) % modulus;
  if (bytes < 8) for (let i = 0; i < rows; ++i) if (codes[i] < 0) codes[i] += modulus;
  return codes;
}

function toTimes(codes) {
  for (let i = 0; i < codes.length; ++i) codes[i] /= 1e9;
}

/// In halves: step · code may overflow where the value does not.
function toValues(codes, none, offset, step) {
  for (let i = 0; i < codes.length; ++i)
    codes[i] = codes[i] === none ? NaN : 2 * (offset / 2 + (step / 2) * codes[i]);
}
