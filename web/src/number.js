// Numbers as they stand in the page.

const kMinus = "−";

/// A value of a signal whose greatest size is `greatest`: with as many decimals as four digits of
/// that one have, so that what changes with the time does not jump. Whole numbers stay so.
export function valueText(value, greatest, whole) {
  if (value == null || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  const sign = value < 0 ? kMinus : "";
  if (size === 0 && greatest === 0) return "0";
  if (whole && greatest < 1e7) return sign + String(size);
  if (greatest >= 1e5 || greatest < 1e-4)
    return sign + size.toExponential(2).replace("e+", "e").replace("e-", `e${kMinus}`);
  const text = size.toFixed(Math.max(3 - Math.floor(Math.log10(greatest)), 0));
  return Number(text) ? sign + text : text;
}

/// Seconds with as many digits as the span of the run asks for.
export function timeText(time, span) {
  const digits = span > 100 ? 2 : span > 0.5 ? 3 : 5;
  return (time < 0 ? kMinus : "") + Math.abs(time).toFixed(digits);
}
