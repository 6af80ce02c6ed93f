// The parts of the page that need no browser: poses, layouts, numbers.

import assert from "node:assert/strict";
import { test } from "node:test";

import { Clock } from "../src/clock.js";
import { LiveClock } from "../src/live_clock.js";
import { LiveRun } from "../src/live_run.js";
import { Kinematics, multiply, pose, transform } from "../src/kinematics.js";
import { carriedOver, firstLayout, takes, withNames, without } from "../src/layout.js";
import { timeText, valueText } from "../src/number.js";
import { multipleOfIdentity, numberText, spanOf } from "../src/parameter_controls.js";
import { decodeRows } from "../src/rows.js";
import { throttled } from "../src/throttle.js";

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
  assert.equal(valueText(-1e-9, 0.001), "0.000000");
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

// ---- a run that goes on ------------------------------------------------------------------------

function liveClockOf(seconds) {
  const clock = new LiveClock(() => {});
  clock.setSpan(0, seconds);
  return clock;
}

test("a live clock follows the newest row until somebody looks back", (t) => {
  withFrames(t);
  const clock = liveClockOf(1);
  assert.equal(clock.time, 1);
  clock.setSpan(0, 2);
  assert.equal(clock.time, 2);
  clock.seek(0.5);
  clock.setSpan(0, 3);
  assert.deepEqual([clock.time, clock.following], [0.5, false]);
  clock.follow();
  assert.deepEqual([clock.time, clock.following], [3, true]);
});

test("space holds a live clock and lets it follow again", (t) => {
  withFrames(t);
  const clock = liveClockOf(1);
  clock.toggleFollowing();
  clock.setSpan(0, 2);
  assert.equal(clock.time, 1);
  clock.toggleFollowing();
  assert.equal(clock.time, 2);
});

test("a live clock that plays the past follows once it has caught up", (t) => {
  const frame = withFrames(t);
  const clock = liveClockOf(1);
  clock.seek(0.5);
  clock.play();
  frame(250);
  assert.deepEqual([clock.time, clock.following], [0.75, false]);
  frame(1000);
  assert.deepEqual([clock.time, clock.following, clock.playing], [1, true, false]);
  clock.pause();
  clock.play(); // at the end already
  assert.ok(clock.following);
});

test("a live clock whose run has ended is one that plays", (t) => {
  const frame = withFrames(t);
  const clock = liveClockOf(1);
  clock.end();
  assert.deepEqual([clock.following, clock.moving], [false, false]);
  clock.follow();
  assert.ok(!clock.following);
  clock.toggleFollowing();
  frame(250);
  assert.deepEqual([clock.time, clock.playing], [0.25, true]);
  frame(2000);
  assert.deepEqual([clock.time, clock.moving], [1, false]);
});

/// A run of the columns time, a and b with one row, at 0 s.
function liveRun(most) {
  const column = (value) => ({ values: Float64Array.of(value), step: 1, bits: 24 });
  const columns = ["time", "a", "b"].map((name) => ({ name, unit: "" }));
  return new LiveRun({ columns }, [0, 1, 2].map(column), most);
}

const rowsFrom = (first, count) =>
  Float64Array.from({ length: 3 * count }, (_, i) => (first + Math.floor(i / 3)) / 100 + (i % 3));

test("rows that are there already are not added again", () => {
  const run = liveRun();
  assert.deepEqual(run.append(rowsFrom(0, 5)), { added: 4, missing: 0 });
  assert.deepEqual(run.append(rowsFrom(3, 4)), { added: 2, missing: 0 });
  assert.deepEqual(run.append(rowsFrom(0, 7)), { added: 0, missing: 0 });
  assert.deepEqual(Array.from(run.times), [0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06]);
  assert.equal(run.columns[1].values[6], 2.06);
  assert.equal(run.columns[1].greatest, 2.06);
});

test("a row whose time was rounded in the page is the same row", () => {
  const run = liveRun();
  run.append(rowsFrom(1, 1));
  assert.equal(run.append(Float64Array.of(0.01 + 4e-10, 1, 2)).added, 0);
});

test("a pause between rows is told, rows one after the other have none", () => {
  const run = liveRun();
  run.append(rowsFrom(1, 5));
  assert.equal(run.append(rowsFrom(6, 5)).missing, 0);
  const { added, missing } = run.append(rowsFrom(111, 5));
  assert.equal(added, 5);
  near([missing], [1], 1e-9); // 0.11 to 1.10 s are missing
});

test("a column that was whole at first is not any more once a fraction comes", () => {
  const run = liveRun();
  assert.equal(run.columns[0].step, 1);
  run.append(rowsFrom(1, 1));
  assert.equal(run.columns[0].step, 0);
});

test("beyond its most rows a run leaves out every second one of the older half", () => {
  const run = liveRun(100);
  run.append(rowsFrom(1, 99));
  assert.deepEqual([run.times.length, run.thinnedUntil], [100, null]);
  run.append(rowsFrom(100, 1));
  // 101 rows: of the first 50 every second is kept.
  assert.equal(run.times.length, 76);
  assert.deepEqual(Array.from(run.times.slice(23, 27)), [0.46, 0.48, 0.5, 0.51]);
  assert.equal(run.thinnedUntil, 0.49);
  for (let i = 0; i < 5000; ++i) run.append(rowsFrom(101 + i, 1));
  assert.ok(run.times.length <= 100);
  assert.equal(run.to, 51);
  assert.equal(run.from, 0);
  assert.ok(run.times.every((time, i) => i === 0 || time > run.times[i - 1]));
  assert.ok(run.columns[0].values.every((a, i) => a === run.times[i] + 1 || i === 0));
});

test("a plot of a window needs its rows and one more on either side", () => {
  const run = liveRun();
  run.append(rowsFrom(1, 100));
  assert.deepEqual(run.rowsFor(0.105, 0.205), [10, 22]);
  assert.deepEqual(run.rowsFor(-1, 2), [0, 101]);
});

/// A float64[] in CDR, at an odd place of a larger buffer.
function cdrOf(numbers) {
  const view = new DataView(new ArrayBuffer(25 + 8 * numbers.length), 13);
  view.setUint8(1, 1);
  view.setUint32(4, numbers.length, true);
  numbers.forEach((value, i) => view.setFloat64(12 + 8 * i, value, true));
  return view;
}

test("rows come out of CDR as they went in", () => {
  assert.deepEqual(decodeRows(cdrOf([1, -2.5, NaN, 4]), 2), Float64Array.of(1, -2.5, NaN, 4));
  assert.deepEqual(decodeRows(cdrOf([]), 2), Float64Array.of());
});

test("rows of another width, or cut off, are refused", () => {
  assert.throws(() => decodeRows(cdrOf([1, 2, 3]), 2), /3 numbers make no rows of 2; reload/);
  const whole = cdrOf([1, 2]);
  const cut = new DataView(whole.buffer, 13, whole.byteLength - 1);
  assert.throws(() => decodeRows(cut, 2), /rows are cut off: 27 bytes/);
});

test("calls that come too often are passed on at the pace that is allowed, the last one always", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  let now = 0;
  t.mock.method(performance, "now", () => now);
  const passed = [];
  const act = throttled(50, (value) => passed.push([now, value]));
  const tick = (milliseconds) => {
    now += milliseconds;
    t.mock.timers.tick(milliseconds);
  };
  for (let i = 0; i < 10; ++i, tick(10)) act(i);
  assert.deepEqual(passed, [
    [0, 0],
    [50, 4],
    [100, 9],
  ]);
  tick(500);
  assert.equal(passed.length, 3);
});

test("a slider begins with room for twice its number, on both sides if that is negative", () => {
  assert.deepEqual(spanOf(0), [0, 2]);
  assert.deepEqual(spanOf(30), [0, 60]);
  assert.deepEqual(spanOf(-9.81), [-19.62, 19.62]);
});

test("numbers stand in fields with six digits", () => {
  assert.equal(numberText(0.1 + 0.2), "0.3");
  assert.equal(numberText(-1234567), "-1234570");
  assert.equal(numberText(undefined), "");
});

test("a multiple of the identity is told from other matrices", () => {
  assert.equal(multipleOfIdentity([3, 0, 0, 3], 2), 3);
  assert.equal(multipleOfIdentity([3, 0, 1, 3], 2), undefined);
  assert.equal(multipleOfIdentity([3, 0, 0, 2], 2), undefined);
});
