// The parts of the page that need no browser: poses, layouts, numbers.

import assert from "node:assert/strict";
import { test } from "node:test";

import { Clock } from "../src/clock.js";
import { Kinematics, multiply, pose, transform } from "../src/kinematics.js";
import { carriedOver, firstLayout, takes, withNames, without } from "../src/layout.js";
import { timeText, valueText } from "../src/number.js";

function near(found, expected, tolerance) {
  found.forEach((value, i) =>
    assert.ok(Math.abs(value - expected[i]) <= tolerance, `${found} is not ${expected}`),
  );
}

const kRoundOff = 1e-14;

function planar(lengths) {
  const links = ["base", ...lengths.map((_, i) => `link_${i + 1}`)].map((name) => ({ name }));
  const joints = lengths.map((_, i) => ({
    name: `joint_${i + 1}`,
    parent: links[i].name,
    child: links[i + 1].name,
    type: "revolute",
    axis: [0, 0, 1],
    position: [i ? lengths[i - 1] : 0, 0, 0],
    rotation: [1, 0, 0, 0],
  }));
  return { links, joints };
}

test("a planar arm reaches where its closed form says", () => {
  const arm = new Kinematics(planar([0.4, 0.3]));
  for (const [a, b] of [
    [0.3, -1.1],
    [2.5, 0.7],
    [-3, 3],
  ]) {
    const tip = transform(arm.poses([a, b]).get("link_2"), [0.3, 0, 0]);
    const expected = [
      0.4 * Math.cos(a) + 0.3 * Math.cos(a + b),
      0.4 * Math.sin(a) + 0.3 * Math.sin(a + b),
      0,
    ];
    near(tip, expected, kRoundOff);
  }
});

test("the order of the joints in the list does not matter for the poses", () => {
  const robot = planar([0.4, 0.3]);
  const inOrder = new Kinematics(robot).poses([0.3, -1.1]).get("link_2");
  const turned = new Kinematics({ ...robot, joints: [...robot.joints].reverse() });
  near(turned.poses([-1.1, 0.3]).get("link_2"), inOrder, kRoundOff);
});

test("a prismatic joint moves along its axis in the frame of its origin", () => {
  const quarter = [Math.SQRT1_2, 0, 0, Math.SQRT1_2]; // 90° about z
  const slide = new Kinematics({
    links: [{ name: "a" }, { name: "b" }],
    joints: [
      {
        name: "j",
        parent: "a",
        child: "b",
        type: "prismatic",
        axis: [2, 0, 0],
        position: [1, 0, 0],
        rotation: quarter,
      },
    ],
  });
  near(transform(slide.poses([0.5]).get("b"), [0, 0, 0]), [1, 0.5, 0], kRoundOff);
});

test("a fixed joint takes no angle", () => {
  const robot = planar([0.4, 0.3]);
  robot.joints[0].type = "fixed";
  const arm = new Kinematics(robot);
  assert.equal(arm.movable.length, 1);
  near(transform(arm.poses([Math.PI / 2]).get("link_2"), [0.3, 0, 0]), [0.4, 0.3, 0], kRoundOff);
});

test("a rotation of a pose has orthonormal columns", () => {
  const length = Math.hypot(0.3, -0.5, 0.2, 0.9);
  const turned = pose(
    [1, 2, 3],
    [0.3, -0.5, 0.2, 0.9].map((v) => v / length),
  );
  const transposed = pose();
  for (let row = 0; row < 3; ++row)
    for (let column = 0; column < 3; ++column)
      transposed[4 * row + column] = turned[4 * column + row];
  near(multiply(transposed, turned).slice(0, 11), pose().slice(0, 11), kRoundOff);
});

test("a joint that hangs on no link is named", () => {
  const robot = planar([0.4]);
  robot.joints[0].parent = "nowhere";
  assert.throws(() => new Kinematics(robot), /“joint_1” hangs on no link/);
});

function runOf(units) {
  const columns = Object.entries(units).map(([name, unit]) => ({ name, path: name[0], unit }));
  return {
    byName: new Map(columns.map((column) => [column.name, column])),
    paths: () =>
      Map.groupBy?.(columns, (c) => c.path) ??
      columns.reduce((paths, c) => paths.set(c.path, [...(paths.get(c.path) ?? []), c]), new Map()),
  };
}

const kRun = runOf({ a1: "rad", a2: "rad", b1: "N", c1: "m", d1: "s" });

test("the first plots are those asked for, or one for each of the first three paths", () => {
  assert.deepEqual(firstLayout(kRun, [["a", "c"], ["none"], ["d"]]), [["a1", "a2", "c1"], ["d1"]]);
  assert.deepEqual(firstLayout(kRun), [["a1", "a2"], ["b1"], ["c1"]]);
});

test("a layout is carried over to a run that has some of its columns", () => {
  const other = runOf({ a2: "rad", e1: "V" });
  assert.deepEqual(carriedOver([["a1", "a2"], ["b1"]], other), [["a2"]]);
  assert.deepEqual(carriedOver([["b1"]], other), [["a2"], ["e1"]]);
});

test("columns move between plots, and an empty plot goes", () => {
  assert.deepEqual(withNames([["a1"], ["b1"]], ["b1"], 0), [["a1", "b1"]]);
  assert.deepEqual(withNames([["a1"]], ["c1"], -1), [["a1"], ["c1"]]);
  assert.deepEqual(without([["a1"], ["b1"]], ["a1"]), [["b1"]]);
});

test("a plot takes columns of two units, not of three", () => {
  assert.ok(takes(kRun, ["a1"], ["b1"]));
  assert.ok(!takes(kRun, ["a1", "b1"], ["c1"]));
});

test("values have the decimals that four digits of the greatest have", () => {
  assert.equal(valueText(-0.08291, 6.1), "−0.083");
  assert.equal(valueText(20.3456, 20.5), "20.35");
  assert.equal(valueText(0.00154321, 0.0016), "0.001543");
  assert.equal(valueText(1234.5, 99999), "1235");
  assert.equal(valueText(1.234e-5, 2e-5), "1.23e−5");
  assert.equal(valueText(1.2e7, 2e7), "1.20e7");
  assert.equal(valueText(-3, 4, true), "−3");
  assert.equal(valueText(0, 0), "0");
  assert.equal(valueText(NaN, 1), "–");
});

test("times have the digits that their span asks for", () => {
  assert.equal(timeText(1.23456, 6), "1.235");
  assert.equal(timeText(-1.23456, 600), "−1.23");
  assert.equal(timeText(0.012345, 0.1), "0.01235");
});

/// Frames that are drawn when the test says so.
function withFrames(t) {
  const waiting = new Map();
  let last = 0;
  globalThis.requestAnimationFrame = (act) => (waiting.set(++last, act), last);
  globalThis.cancelAnimationFrame = (id) => waiting.delete(id);
  t.mock.method(performance, "now", () => 0);
  t.after(() => {
    delete globalThis.requestAnimationFrame;
    delete globalThis.cancelAnimationFrame;
  });
  return (milliseconds) => {
    const acts = [...waiting.values()];
    waiting.clear();
    for (const act of acts) act(milliseconds);
  };
}

function clockOf(seconds) {
  const clock = new Clock(() => {});
  clock.setSpan(0, seconds);
  return clock;
}

test("a clock plays as fast as its speed says, and stops at the end", (t) => {
  const frame = withFrames(t);
  const clock = clockOf(1);
  clock.setSpeed(2);
  clock.play();
  frame(250);
  assert.equal(clock.time, 0.5);
  frame(750);
  assert.equal(clock.time, 1);
  assert.ok(!clock.playing);
});

test("a clock paused and played again before the next frame is as fast as before", (t) => {
  const frame = withFrames(t);
  const clock = clockOf(6);
  clock.play();
  clock.pause();
  clock.play();
  frame(250);
  assert.equal(clock.time, 0.25);
});

test("a paused clock stands still", (t) => {
  const frame = withFrames(t);
  const clock = clockOf(6);
  clock.play();
  frame(250);
  clock.pause();
  frame(500);
  assert.equal(clock.time, 0.25);
});
