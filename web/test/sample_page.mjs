// A page with made-up runs of a made-up arm, as a report has them.

import { readFileSync } from "node:fs";
import { join } from "node:path";

import { encodePageData } from "./encode.mjs";

const kJoints = 7;
const kRate = 1000;

// Of analysis/report_page.cc: the variables, the text column, and what else may meet the replay.
const kSheet = `
:root { color-scheme: light dark; --paper: #fff; --blue: #0072b2; --vermillion: #d55e00;
  --green: #009e73; --purple: #cc79a7; --sky: #56b4e9; --amber: #e69f00; --ink: #262626;
  --grey: #737373; --grid: #d9d9d9; }
@media screen and (prefers-color-scheme: dark) { :root { --paper: #16191d; --blue: #4aa8ec;
  --vermillion: #ff8f4a; --green: #2fcb9d; --purple: #e79fc8; --sky: #a6dcfa; --amber: #ffc84f;
  --ink: #e4e6e9; --grey: #a0a6ad; --grid: #3c4248; } }
body { margin: 0 auto; max-width: 62rem; padding: 2rem 1.5rem 4rem; color: var(--ink);
  background: var(--paper); font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.15rem; margin: 2.5rem 0 .6rem; }
p { margin: .5rem 0; max-width: 48rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; width: 100%; }
th, td { padding: .4rem .7rem; text-align: left; border-bottom: 1px solid var(--grid); }
figure { margin: 1.2rem 0 2rem; break-inside: avoid; }
figure svg { display: block; width: 100%; height: auto; }
`;

/// Numbers in (−1, 1), the same in every run of the test.
function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (state * 1664525 + 1013904223) % 4294967296;
    return state / 2147483648 - 1;
  };
}

function runOf(title, data, seconds, stiffness) {
  const random = randomNumbers(7);
  const times = Array.from({ length: seconds * kRate + 1 }, (_, i) => i / kRate);
  const columns = [{ name: "time", unit: "s" }];
  const numbers = [times];
  const add = (path, element, unit, value) => {
    columns.push({ name: element ? `${path}[${element}]` : path, path, element, unit });
    numbers.push(times.map(value));
  };
  const joints = Array.from({ length: kJoints }, (_, j) => `joint_${j + 1}`);
  const rest = [0, 0.35, 0.2, 1.9, 0.1, 0.9, 0];
  const push = (t) => (t > 0.5 && t < 2 ? 30 * Math.sin((Math.PI * (t - 0.5)) / 1.5) ** 2 : 0);
  const give = (t, j) => (push(t) * Math.sin(1 + j)) / stiffness;
  const swing = (t, j) => 0.25 * Math.sin(1.7 * t + 0.9 * j) * Math.exp(-0.15 * t);
  joints.forEach((joint, j) =>
    add("arm.measured_position", joint, "rad", (t) => rest[j] + swing(t, j) + give(t, j)),
  );
  joints.forEach((joint, j) =>
    add(
      "arm.measured_velocity",
      joint,
      "rad/s",
      (t) => 0.42 * Math.cos(1.7 * t + 0.9 * j) * Math.exp(-0.15 * t) + 0.01 * random(),
    ),
  );
  joints.forEach((joint, j) =>
    add("qp.torque", joint, "N·m", (t) => 20 * Math.cos(j) + 4 * swing(t, j) + 0.4 * random()),
  );
  joints.forEach((joint, j) =>
    add("momentum.external_torque", joint, "N·m", (t) =>
      t < 0.05 ? NaN : push(t) * 0.2 * Math.cos(j) + 0.3 * random(),
    ),
  );
  add("push_1.force.link", "", "", (t) => (push(t) > 0 ? kFrames.indexOf("forearm_link") : -1));
  for (const axis of ["x", "y", "z"])
    add("push_1.force.point", axis, "m", () => ({ x: 0, y: 0, z: 0.1 })[axis]);
  for (const axis of ["x", "y", "z"])
    add("push_1.force.force", axis, "N", (t) => push(t) * { x: -0.4, y: 0.9, z: 0.1 }[axis]);
  for (const axis of ["x", "y", "z"])
    add("pose.error", axis, "m", (t) => push(t) / stiffness ** 2 / 3 + 1e-5 * random());
  add("qp.status", "", "", (t) => (t > 1 && t < 1.1 ? 1 : 0));
  add("qp.iterations", "", "", (t) => Math.floor(3 + 2 * random()));
  return {
    about: {
      title,
      data,
      rows: times.length,
      decimation: "every value is shown",
      columns,
      joints: joints.map((joint) => `arm.measured_position[${joint}]`),
      forces: [
        {
          name: "push_1.force",
          link: "push_1.force.link",
          point: ["x", "y", "z"].map((axis) => `push_1.force.point[${axis}]`),
          force: ["x", "y", "z"].map((axis) => `push_1.force.force[${axis}]`),
        },
      ],
      bands: [{ from: 0.5, to: 2, label: "push_1" }],
    },
    text: encodePageData(numbers),
  };
}

const kFrames = [
  "base_link",
  "shoulder_link",
  "upper_link",
  "elbow_link",
  "forearm_link",
  "wrist_link",
  "hand_link",
  "tool_link",
];

const kHalf = Math.SQRT1_2;

function robot() {
  const lengths = [0.16, 0.13, 0.21, 0.21, 0.21, 0.12, 0.11, 0.12];
  const light = [0.86, 0.87, 0.88];
  const dark = [0.32, 0.34, 0.37];
  const links = kFrames.map((name, i) => ({
    name,
    visuals: [
      {
        shape: "cylinder",
        radius: 0.047 - 0.002 * i,
        length: lengths[i],
        position: [0, 0, lengths[i] / 2],
        rotation: [1, 0, 0, 0],
        color: light,
      },
      { shape: "sphere", radius: 0.05 - 0.002 * i, position: [0, 0, lengths[i]], color: dark },
    ],
  }));
  links[0].visuals.push({
    shape: "box",
    size: [0.2, 0.2, 0.02],
    position: [0, 0, 0.01],
    color: dark,
  });
  links[7].visuals = [
    { shape: "capsule", radius: 0.025, length: 0.06, position: [0, 0, 0.05], color: light },
  ];
  const joints = kFrames.slice(1).map((child, i) => ({
    name: `joint_${i + 1}`,
    parent: kFrames[i],
    child,
    type: i % 2 ? "revolute" : "continuous",
    axis: i % 2 ? [0, 1, 0] : [0, 0, 1],
    position: [0, 0, lengths[i]],
    rotation: [1, 0, 0, 0],
  }));
  joints.push({
    name: "flange",
    parent: "hand_link",
    child: "flange_link",
    type: "fixed",
    position: [0, 0, 0.05],
    rotation: [kHalf, 0, kHalf, 0],
  });
  links.push({ name: "flange_link", visuals: [] });
  return { links, joints: [joints.pop(), ...joints], frames: kFrames };
}

/// The page with what `folder` holds, dist/ as a rule.
export function samplePage(folder) {
  const runs = [
    runOf("stiff, Γ = 0", "data-0", 6, 80),
    runOf("compliant in the null space, Γ = 0.8 I", "data-1", 4, 30),
  ];
  return pageOf(folder, "replay", { runs });
}

/// The page of a run that goes on, of which one second has passed; and the columns of its rows.
export function sampleLivePage(folder, live) {
  const run = runOf(live.title, "data-0", 1, 80);
  return { html: pageOf(folder, "live", { runs: [run], live }), columns: run.about.columns };
}

function pageOf(folder, bundle, { runs, live }) {
  const json = JSON.stringify({
    plots: [["arm.measured_position"], ["qp.torque"], ["momentum.external_torque"]],
    runs: runs.map((run) => run.about),
    robot: robot(),
    live,
  });
  const read = (name) => readFileSync(join(folder, name), "utf8");
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>A made-up report</title>
<style>${kSheet}</style>
</head>
<body>
<h1>Null-space compliance of a made-up arm</h1>
<p>An arm of seven joints is pushed while it holds its hand; two controllers are compared.</p>
<section id="replay"></section>
<h2>Settings</h2>
<p>The text goes on below the replay.</p>
<script type="application/json" id="runs">${json.replaceAll("<", "\\u003c")}</script>
${runs.map((run) => `<script type="text/plain" id="${run.about.data}">${run.text}</script>`).join("\n")}
<style>${read(`${bundle}.css`)}</style>
<script>${read(`${bundle}.js`)}</script>
</body>
</html>
`;
}
