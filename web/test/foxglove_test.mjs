// A run that is shown, as other clients of the Foxglove WebSocket protocol see it.
//
//   node foxglove_test.mjs PLIANT SCENARIO

import assert from "node:assert/strict";

import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

import { connect } from "./foxglove_client.mjs";
import { show } from "./live_process.mjs";

const [pliant, scenario] = process.argv.slice(2);
const { address, ended } = await show(pliant, scenario, "--set", "station.ideal=true");
const { client, info, heard, channel, topics, parameters } = await connect(address);

async function test(name, act) {
  await act();
  console.log(`ok  ${name}`);
}

/// The next message of a topic, as the schema of its channel has it.
async function next(topic) {
  const { id, encoding, schema } = await channel(topic);
  const subscription = client.subscribe(id);
  const { data } = await heard("message", (event) => event.subscriptionId === subscription);
  client.unsubscribe(subscription);
  if (encoding === "json") return JSON.parse(new TextDecoder().decode(data));
  assert.equal(encoding, "cdr");
  return new MessageReader(parse(schema, { ros2: true })).readMessage(data);
}

function publish(topic, message) {
  const id = client.advertise({ topic, encoding: "json", schemaName: "" });
  client.sendMessage(id, new TextEncoder().encode(JSON.stringify(message)));
}

await test("the server says that it takes parameters and messages", () => {
  assert.equal(info.name, "pliant");
  for (const one of ["parameters", "parametersSubscribe", "clientPublish"])
    assert.ok(info.capabilities.includes(one), `${info.capabilities}`);
});

await test("the topics of the log are there, and those of the page", async () => {
  for (const topic of ["/joint_states", "/robot_description", "/pliant/rows", "/pliant/run"])
    assert.equal((await channel(topic)).topic, topic, `${topics()}`);
});

await test("joint states have seven joints, and their time goes on", async () => {
  const first = await next("/joint_states");
  assert.deepEqual(
    first.name,
    [1, 2, 3, 4, 5, 6, 7].map((j) => `joint_${j}`),
  );
  assert.ok(first.position.every(Number.isFinite));
  assert.equal(first.velocity.length, 7);
  const seconds = ({ header }) => header.stamp.sec + 1e-9 * header.stamp.nanosec;
  // The only message so far is told to each who subscribes: it may be the first once more.
  let later;
  do later = await next("/joint_states");
  while (seconds(later) === seconds(first));
  assert.ok(seconds(later) > seconds(first));
});

await test("the run says how it goes", async () => {
  const { state, time, late, dropped } = await next("/pliant/run");
  assert.equal(state, "running");
  for (const number of [time, late, dropped]) assert.ok(number >= 0);
});

const kCompliance = "control.posture.compliance";
const identity = (gamma) => Array.from({ length: 49 }, (_, k) => (k % 8 ? 0 : gamma));

await test("a parameter is read, set, and told to who watches it", async () => {
  const all = await parameters();
  assert.deepEqual(all.get(kCompliance), identity(1));
  const wanted = identity(0.5);
  const told = heard(
    "parameterValues",
    (event) => !event.id && event.parameters.some(({ name }) => name === kCompliance),
  );
  client.subscribeParameterUpdates([kCompliance]);
  client.setParameters([{ name: kCompliance, value: wanted, type: "float64_array" }]);
  assert.deepEqual((await told).parameters, [
    { name: kCompliance, value: wanted, type: "float64_array" },
  ]);
  assert.deepEqual((await parameters(kCompliance)).get(kCompliance), wanted);
});

await test("a parameter that is refused says why, and keeps its value", async () => {
  const before = await parameters(kCompliance);
  const status = heard("status");
  client.setParameters([{ name: kCompliance, value: [1, 2] }], "refused");
  const { level, message } = await status;
  assert.equal(level, 2);
  assert.match(message, /^control\.posture\.compliance: expected 49 finite numbers, got \[1,2\]/);
  assert.deepEqual(await parameters(kCompliance), before);
});

await test("a parameter that there is not is named, with the nearest", async () => {
  const status = heard("status");
  client.setParameters([{ name: "control.posture.complianc", value: 1 }]);
  assert.match((await status).message, /no parameter 'control.posture.complianc'.*compliance/s);
});

await test("a push moves the arm", async () => {
  const rest = await next("/joint_states");
  const pushing = setInterval(
    () => publish("/push", { link: "forearm_link", point: [0, 0, 0], force: [0, 30, 0] }),
    50,
  );
  try {
    const away = ({ position }) =>
      Math.max(...position.map((q, j) => Math.abs(q - rest.position[j])));
    while (away(await next("/joint_states")) < 0.05);
  } finally {
    clearInterval(pushing);
  }
});

await test("a push on a link that there is not is refused", async () => {
  const status = heard("status");
  publish("/push", { link: "tail", point: [0, 0, 0], force: [0, 0, 0] });
  assert.match((await status).message, /no link 'tail'/);
});

await test("/pliant/stop ends the run", async () => {
  const { id } = await channel("/pliant/run");
  const subscription = client.subscribe(id);
  const last = heard("message", ({ subscriptionId, data }) => {
    if (subscriptionId !== subscription) return false;
    return JSON.parse(new TextDecoder().decode(data)).state === "ended";
  });
  publish("/pliant/stop", {});
  await last;
  console.log(`pliant ended with ${await ended}`);
});
