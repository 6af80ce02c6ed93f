// Numbers as they stand in the page.

const kMinus = "−";

/// Four significant digits, without an exponent where one reads better without.
export function numberText(value) {
  if (value == null || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  let text;
  if (Number.isInteger(value) && size < 1e6) text = String(size);
  else if (size >= 1e-3 && size < 1e5) text = size.toPrecision(4);
  else text = size.toExponential(2).replace("e+", "e").replace("e-", `e${kMinus}`);
  return value < 0 ? kMinus + text : text;
}

/// Seconds with as many digits as the span of the run asks for.
export function timeText(time, span) {
  const digits = span > 100 ? 2 : span > 0.5 ? 3 : 5;
  return (time < 0 ? kMinus : "") + Math.abs(time).toFixed(digits);
}
