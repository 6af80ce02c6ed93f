// Calls that come too often.

/// A function that passes calls on at most every `period` milliseconds, and the last one always.
export function throttled(period, act) {
  let last = -Infinity;
  let timer = null;
  let latest;
  const pass = () => {
    timer = null;
    last = performance.now();
    act(...latest);
  };
  return (...values) => {
    latest = values;
    if (timer !== null) return;
    const wait = last + period - performance.now();
    if (wait > 0) timer = setTimeout(pass, wait);
    else pass();
  };
}
