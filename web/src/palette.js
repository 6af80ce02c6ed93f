// The colours of the report, which its style sheet has as variables, light or dark.

const kFallback = {
  paper: "#ffffff",
  ink: "#262626",
  grey: "#737373",
  grid: "#d9d9d9",
  blue: "#0072b2",
  vermillion: "#d55e00",
  green: "#009e73",
  purple: "#cc79a7",
  sky: "#56b4e9",
  amber: "#e69f00",
};

/// In the order of curves, told apart by colour-blind readers and in grey.
const kCurves = ["blue", "vermillion", "green", "purple", "sky", "amber", "grey"];

const kDashes = [[], [6, 4], [2, 3], [8, 3, 2, 3]];

export function readPalette() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(
    Object.entries(kFallback).map(([name, colour]) => [
      name,
      style.getPropertyValue(`--${name}`).trim() || colour,
    ]),
  );
}

/// The n-th element of a path has the n-th colour in every plot; what comes after the last colour,
/// or is of another path in the same plot, has another dash.
export function curveStyle(palette, element, path) {
  const round = Math.floor(element / kCurves.length) + path;
  return {
    colour: palette[kCurves[element % kCurves.length]],
    dash: kDashes[round % kDashes.length],
  };
}

/// Calls `changed` when the reader goes from light to dark or back.
export function watchScheme(changed) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
}
