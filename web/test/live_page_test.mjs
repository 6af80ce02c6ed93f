// The page of a run that goes on, with a run that is made up: what it asks for, and what it does with
// each answer.
//
//   node live_page_test.mjs DIST [BROWSER]

import assert from "node:assert/strict";

import { drawn, launch, ready } from "./browser.mjs";
import { sampleLivePage } from "./sample_page.mjs";

const [dist, executablePath] = process.argv.slice(2);
const kAddress = "http://127.0.0.1:8765/";
const kChannels = ["/pliant/rows", "/pliant/run"].map((topic, id) => ({
  id,
  topic,
  encoding: id ? "json" : "cdr",
  schemaName: "",
  schema: "",
}));
const kParameters = [
  { name: "loop.gain", about: "of the loop", kind: "number", unit: "N", value: 3 },
  { name: "loop.count", kind: "number", whole: true, value: 4 },
  { name: "gravity.z", kind: "number", unit: "m/s²", value: -9.81 },
  { name: "loop.on", kind: "flag", value: true },
  { name: "operator.mode", kind: "word", words: ["stiff", "soft"], value: "stiff" },
  { name: "operator.choice", kind: "word", words: [..."abcdefgh"], value: "a" },
  { name: "pose.stiffness", kind: "numbers", elements: ["x", "y"], value: [100, 100] },
  { name: "pose.damping", kind: "numbers", elements: ["x", "y"], value: [20, 30] },
  { name: "pose.limit", kind: "number", unit: "N", value: null },
];
const kLive = {
  title: "A made-up run",
  duration: null,
  control: true,
  push: true,
  shown: kParameters.slice(0, 8).map(({ name }) => name),
  parameters: kParameters,
};

async function test(name, act) {
  await act();
  console.log(`ok  ${name}`);
}

const browser = await launch(executablePath);

/// A page with a server that is made up: `sent` is what the page has said.
async function openPage(live = kLive) {
  const { html, columns } = sampleLivePage(dist, live);
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
  context.setDefaultTimeout(120000);
  const page = await context.newPage();
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  const server = { sent: [], session: "first", opened: 0, loaded: 0 };
  await context.route("**/*", (route) => {
    ++server.loaded;
    return route.fulfill({ contentType: "text/html; charset=utf-8", body: html });
  });
  await context.routeWebSocket(/.*/, (socket) => {
    ++server.opened;
    server.socket = socket;
    server.subscriptions = new Map();
    socket.onMessage((message) => {
      const said = typeof message === "string" ? JSON.parse(message) : publishedIn(message);
      server.sent.push(said);
      for (const { id, channelId } of said.subscriptions ?? [])
        server.subscriptions.set(kChannels[channelId].topic, id);
    });
    server.tell({ op: "serverInfo", capabilities: ["clientPublish"], sessionId: server.session });
    server.tell({ op: "advertise", channels: kChannels });
  });
  server.tell = (message) => server.socket.send(JSON.stringify(message));
  server.deliver = (topic, content) => {
    const head = Buffer.alloc(13);
    head.writeUInt8(1, 0);
    head.writeUInt32LE(server.subscriptions.get(topic), 1);
    server.socket.send(Buffer.concat([head, content]));
  };
  /// Rows at 100 Hz, from a time on.
  server.rows = (from, count) => {
    const content = Buffer.alloc(12 + 8 * count * columns.length);
    content.writeUInt8(1, 1);
    content.writeUInt32LE(count * columns.length, 4);
    for (let row = 0; row < count; ++row)
      content.writeDoubleLE(from + row / 100, 12 + 8 * row * columns.length);
    server.deliver("/pliant/rows", content);
  };
  server.state = (state) => server.deliver("/pliant/run", Buffer.from(JSON.stringify(state)));
  /// What the page has said since, of a kind; waits until there is something.
  server.heard = async (passes) => {
    for (;;) {
      const found = server.sent.findLast(passes);
      if (found) return found;
      await drawn(page);
    }
  };
  server.set = (name) =>
    server.heard(({ op, parameters }) => op === "setParameters" && parameters[0].name === name);
  await page.goto(kAddress);
  await ready(page);
  await server.heard(({ op }) => op === "subscribeParameterUpdates");
  return { page, server, faults, close: () => context.close() };
}

function publishedIn(message) {
  return { channel: message.readUInt32LE(1), message: JSON.parse(message.subarray(5).toString()) };
}

const labelled = (page, name) => page.getByLabel(name, { exact: true });
const rows = (page) => page.evaluate(() => window.pliant.rows());

const { page, server, faults, close } = await openPage();

await test("rows are added as they come, those that are there are not", async () => {
  const before = await rows(page);
  server.rows(0.98, 12);
  await page.waitForFunction((count) => window.pliant.rows() === count, before + 9);
  assert.equal(await page.evaluate(() => window.pliant.values("time").at(-1)), 1.09);
});

await test("each kind of parameter has its control", async () => {
  const value = async (name) => (await server.set(name)).parameters[0].value;
  await labelled(page, "loop.gain").fill("1.5");
  assert.equal(await value("loop.gain"), 1.5);
  await labelled(page, "loop.count").fill("2.7");
  assert.equal(await value("loop.count"), 3);
  assert.equal(await labelled(page, "gravity.z").getAttribute("min"), "-19.62");
  assert.equal(await labelled(page, "gravity.z").getAttribute("max"), "19.62");
  await page.getByRole("switch", { name: "loop.on" }).click();
  assert.equal(await value("loop.on"), false);
  await page.getByRole("group", { name: "operator.mode" }).getByText("soft").click();
  assert.equal(await value("operator.mode"), "soft");
  await labelled(page, "operator.choice").selectOption("c");
  assert.equal(await value("operator.choice"), "c");
  await labelled(page, "pose.stiffness").fill("50");
  assert.deepEqual(await value("pose.stiffness"), [50, 50]);
  assert.equal(await labelled(page, "pose.damping").count(), 0, "its elements are not equal");
  await page.locator('[data-name="pose.damping"]').getByText("2 elements").click();
  await labelled(page, "pose.damping, y").fill("25");
  assert.deepEqual(await value("pose.damping"), [20, 25]);
});

await test("a group opens to show its parameters, and a search opens those that it finds", async () => {
  const group = page.locator("#replay .block");
  assert.equal(await group.count(), 1); // the others are shown first
  assert.equal(await labelled(page, "pose.limit").count(), 0);
  await group.locator("summary").click();
  await labelled(page, "pose.limit").waitFor();
  assert.equal(await labelled(page, "pose.limit, number").inputValue(), "", "it has no number");
  await group.locator("summary").click();
  await labelled(page, "pose.limit").waitFor({ state: "hidden" });
  await labelled(page, "Find a parameter").fill("LIM");
  await labelled(page, "pose.limit").waitFor();
  await labelled(page, "Find a parameter").fill("");
  await labelled(page, "pose.limit").waitFor({ state: "hidden" });
});

await test("a group that is closed stays so, also if a search begins at once", async () => {
  await page.locator("#replay .block summary").click();
  await labelled(page, "pose.limit").waitFor();
  await page.evaluate(() => {
    document.querySelector("#replay .block summary").click();
    const search = document.querySelector('[aria-label="Find a parameter"]');
    search.value = "LIM"; // before the group's toggle event comes
    search.dispatchEvent(new Event("input"));
  });
  await labelled(page, "pose.limit").waitFor();
  await labelled(page, "Find a parameter").fill("");
  await labelled(page, "pose.limit").waitFor({ state: "hidden", timeout: 10000 });
});

await test("while a slider moves 20 changes a second are sent at most, and the last one", async () => {
  const wanted = Array.from({ length: 100 }, (_, i) => i / 50);
  server.sent.length = 0;
  const seconds = await labelled(page, "loop.gain").evaluate(async (slider, values) => {
    const begin = performance.now();
    for (const value of values) {
      slider.value = value;
      slider.dispatchEvent(new Event("input"));
      await new Promise((done) => setTimeout(done, 1));
    }
    return (performance.now() - begin) / 1000;
  }, wanted);
  await server.heard(({ parameters }) => parameters?.[0].value === wanted.at(-1));
  const count = server.sent.filter(({ op }) => op === "setParameters").length;
  // One at once, one at the end.
  assert.ok(count <= 20 * seconds + 2, `${count} changes in ${seconds} s`);
});

await test("a change that is refused says why, and the value that holds comes back", async () => {
  await labelled(page, "loop.gain, number").fill("7");
  await labelled(page, "loop.gain, number").press("Enter");
  await server.heard(({ parameters }) => parameters?.[0].value === 7);
  server.tell({ op: "status", level: 2, message: "loop.gain: expected at most 5, got 7" });
  server.tell({ op: "parameterValues", parameters: [{ name: "loop.gain", value: 2 }] });
  await page.getByRole("alert").getByText("loop.gain: expected at most 5, got 7").waitFor();
  await page.waitForFunction(
    () => document.querySelector('[aria-label="loop.gain, number"]').value === "2",
  );
});

await test("what is no number is not sent", async () => {
  server.sent.length = 0;
  await labelled(page, "loop.gain, number").fill("");
  await labelled(page, "loop.gain, number").press("Tab");
  assert.equal(await labelled(page, "loop.gain, number").inputValue(), "2");
  await labelled(page, "loop.count, number").fill("5");
  await labelled(page, "loop.count, number").press("Enter");
  await server.set("loop.count");
  assert.ok(server.sent.every(({ parameters }) => parameters?.[0].name !== "loop.gain"));
});

await test("refusals of other wishes stand above", async () => {
  server.tell({ op: "status", level: 2, message: "/push: there is no link 'tail'" });
  await page.locator("#replay > [role=alert]").getByText("/push: there is no link").waitFor();
});

await test("the state of the run stands under its title", async () => {
  server.state({ state: "running", time: 1.09, pace: 0.5, late: 3, dropped: 2, safety: "hold" });
  await page
    .locator("#replay .said")
    .getByText("running · 1.1 s · pace 0.50 · supervisor: hold · 3 ticks late · 2 rows dropped")
    .waitFor();
  assert.equal(await page.getByRole("button", { name: "Acknowledge" }).count(), 0);
});

await test("a connection that breaks comes back, and nothing is missing", async () => {
  await server.socket.close();
  await page.locator("#replay .banner").getByText(/cannot be reached/).waitFor();
  assert.ok(await page.getByRole("button", { name: "Stop" }).isDisabled());
  while (server.opened < 2 || !server.subscriptions.has("/pliant/rows")) await drawn(page);
  server.rows(0.5, 100);
  await page.waitForFunction(() => window.pliant.values("time").at(-1) === 1.49);
  await page.locator("#replay .banner").waitFor({ state: "hidden" });
  assert.equal(server.loaded, 1);
});

/// Acts, once it has made the page load itself again.
async function loadsAgain({ page, server }, act) {
  const before = server.opened;
  await page.evaluate(() => (window.before = true));
  act();
  await page.waitForFunction(() => !window.before && window.pliant);
  await ready(page);
  while (server.opened === before) await drawn(page);
}

await test("a page that has missed rows loads itself again", async () => {
  await server.socket.close();
  const opened = server.opened;
  while (server.opened === opened || !server.subscriptions.has("/pliant/rows")) await drawn(page);
  await loadsAgain({ page, server }, () => server.rows(5, 10));
  assert.deepEqual(faults, []);
});
await close();

await test("a page that meets another run loads itself again", async () => {
  const opened = await openPage();
  opened.server.session = "second";
  await loadsAgain(opened, () => opened.server.socket.close());
  assert.deepEqual(opened.faults, []);
  await opened.close();
});

await test("the end of a run is told, with its time and its reason", async () => {
  for (const [reason, said] of [
    ["", "at 2.50 s"],
    ["somebody has stopped it", "at 2.50 s: somebody has stopped it"],
    ["it was stopped at t = 2.5 s.", ": it was stopped at t = 2.5 s"],
  ]) {
    const { page, server, close } = await openPage();
    server.state({ state: "ended", time: 2.5, reason });
    const banner = page.locator("#replay .banner");
    await banner.waitFor();
    assert.equal(
      await banner.innerText(),
      `The run has ended${said.startsWith(":") ? "" : " "}${said}. ` +
        "This page keeps what it has and plays it again.",
    );
    assert.ok(await labelled(page, "loop.gain").isDisabled());
    await close();
  }
});

await test("a run with a supervisor can be acknowledged", async () => {
  const { page, server, close } = await openPage({ ...kLive, supervised: true });
  await page.getByRole("button", { name: "Acknowledge" }).click();
  const { id } = server.sent
    .flatMap(({ channels }) => channels ?? [])
    .find(({ topic }) => topic === "/pliant/acknowledge");
  await server.heard(({ channel }) => channel === id);
  await close();
});

await test("a parameter of an unknown kind is named", async () => {
  const parameters = [{ name: "odd.one", kind: "tensor", value: 1 }];
  const { html } = sampleLivePage(dist, { ...kLive, shown: ["odd.one"], parameters });
  const page = await browser.newPage();
  await page.route("**/*", (route) =>
    route.fulfill({ contentType: "text/html; charset=utf-8", body: html }),
  );
  await page.goto(kAddress);
  assert.match(
    await page.getByRole("alert").innerText(),
    /The run cannot be shown: the parameter odd\.one is of an unknown kind, “tensor”\./,
  );
});

await browser.close();
