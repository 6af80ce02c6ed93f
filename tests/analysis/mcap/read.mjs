// Reads a log of pliant with the MCAP and ROS 2 libraries of Foxglove and holds it against what was
// recorded.
//
//   node read.mjs FILE EXPECTED    a whole log
//   node read.mjs --killed FILE    what a killed process has left

import assert from "node:assert/strict";
import { open, readFile } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";

const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };

/** Decodes messages with the schemas of the file: {topic: [{time, message}]}. */
class Topics {
  schemas = new Map();
  channels = new Map();
  messages = {};
  metadata = {};
  types = new Set();

  add(record) {
    this.types.add(record.type);
    if (record.type === "Schema") {
      assert.equal(record.encoding, "ros2msg");
      this.schemas.set(record.id, record);
    } else if (record.type === "Channel") {
      assert.equal(record.messageEncoding, "cdr");
      assert(record.metadata.get("offered_qos_profiles").startsWith("- history: "));
      assert.match(record.topic, /^(\/[A-Za-z_][A-Za-z0-9_]*)+$/);
      const schema = this.schemas.get(record.schemaId);
      assert.match(schema.name, /^[a-z0-9_]+\/msg\/[A-Z][A-Za-z0-9]*$/);
      const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
      this.channels.set(record.id, { ...record, schema, reader: new MessageReader(definition) });
      this.messages[record.topic] ??= [];
    } else if (record.type === "Message") {
      assert.equal(record.logTime, record.publishTime);
      const channel = this.channels.get(record.channelId);
      const message = channel.reader.readMessage(record.data);
      this.messages[channel.topic].push({ time: record.logTime, message });
    } else if (record.type === "Metadata") {
      this.metadata[record.name] = Object.fromEntries(record.metadata);
    }
  }

  channel(topic) {
    return [...this.channels.values()].find((channel) => channel.topic === topic);
  }
}

/** All there is from the front to the back; `whole` if nothing is left over. */
async function stream(file) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  const topics = new Topics();
  reader.append(new Uint8Array(await readFile(file)));
  for (let record; (record = reader.nextRecord()); ) topics.add(record);
  return { topics, whole: reader.done(), left: reader.bytesRemaining() };
}

async function indexed(file) {
  const handle = await open(file);
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, size) => {
      const { buffer } = await handle.read(new Uint8Array(Number(size)), 0, Number(size), Number(offset));
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const topics = new Topics();
  for (const schema of reader.schemasById.values()) topics.add(schema);
  for (const channel of reader.channelsById.values()) topics.add(channel);
  for await (const message of reader.readMessages({ validateCrcs: true })) topics.add(message);
  for await (const metadata of reader.readMetadata()) topics.add(metadata);
  const slice = [];
  for await (const message of reader.readMessages({
    topics: ["/arm/position"], startTime: 2_000_000_000n, endTime: 2_009_000_000n, validateCrcs: true,
  })) slice.push(message.logTime);
  await handle.close();
  return { topics, reader, slice };
}

const time = (ns) => ({ sec: Number(ns / 1_000_000_000n), nanosec: Number(ns % 1_000_000_000n) });
const stamp = (header) => ({ sec: header.stamp.sec, nanosec: header.stamp.nanosec ?? header.stamp.nsec });
const near = (a, b) => assert(Math.abs(a - b) < 1e-12, `${a} is not ${b}`);  // round-off of a few sums

function checkValues(topics, expected) {
  for (const value of expected.values) {
    const topic = "/" + value.path.replaceAll(".", "/").replaceAll("-", "_");
    const { metadata, schema } = topics.channel(topic);
    assert.equal(metadata.get("pliant.path"), value.path);
    assert.equal(metadata.get("pliant.type"), value.type);
    assert.deepEqual(JSON.parse(metadata.get("pliant.elements")), value.elements);
    assert.deepEqual(JSON.parse(metadata.get("pliant.units")), value.units);

    const fields = new TextDecoder().decode(schema.data).split("\n").filter((l) => l.startsWith("float64 "));
    assert.deepEqual(fields.map((field) => field.split("  # ")[1] ?? ""), value.units);
    assert.equal(topics.messages[topic].length, value.rows.length, topic);
    value.rows.forEach((row, i) => {
      const { time, message } = topics.messages[topic][i];
      assert.equal(time, BigInt(row.time));
      assert.deepEqual(Object.values(message), row.numbers);
    });
  }
}

function checkRobot(topics, expected) {
  const positions = topics.messages["/arm/position"];
  const states = topics.messages["/joint_states"];
  assert.equal(states.length, positions.length);
  states.forEach(({ time: at, message }, i) => {
    const { shoulder, elbow } = positions[i].message;
    assert.equal(at, positions[i].time);
    assert.deepEqual(stamp(message.header), time(at));
    assert.deepEqual(message.name, ["shoulder", "elbow"]);
    assert.deepEqual([...message.position], [shoulder, elbow]);
    assert.deepEqual([...message.velocity], [1, -2]);
    assert.deepEqual([...message.effort], []);
  });

  const transforms = topics.messages["/tf"];
  assert.equal(transforms.length, 1000);  // 100 Hz of 10 s
  transforms.forEach(({ time: at, message }, i) => {
    assert.equal(at, BigInt(i) * 10_000_000n);
    const q = Number(at) / 1e9;
    const expect = [
      ["base", "upper", [0, 0, 0.3], [0, 0, Math.sin(q / 2), Math.cos(q / 2)]],
      ["upper", "lower", [0.5, 0, 0], [0, Math.sin(-q), 0, Math.cos(-q)]],
      ["lower", "tool", [0.4, 0, 0], [0, 0, Math.SQRT1_2, Math.SQRT1_2]],
    ];
    assert.equal(message.transforms.length, expect.length);
    expect.forEach(([parent, child, position, rotation], k) => {
      const { header, child_frame_id, transform } = message.transforms[k];
      assert.deepEqual([header.frame_id, child_frame_id, stamp(header)], [parent, child, time(at)]);
      ["x", "y", "z"].forEach((axis, j) => near(transform.translation[axis], position[j]));
      // A quaternion and its negative are one rotation.
      const r = ["x", "y", "z", "w"].map((axis) => transform.rotation[axis]);
      near(Math.abs(r.reduce((sum, x, j) => sum + x * rotation[j], 0)), 1);
    });
  });

  assert.equal(topics.messages["/robot_description"].length, 1);
  assert.equal(topics.messages["/robot_description"][0].message.data, expected.description);
}

async function checkWhole(file, expectedFile) {
  const expected = JSON.parse(await readFile(expectedFile, "utf8"));
  const front = await stream(file);
  assert(front.whole);
  const { topics, reader, slice } = await indexed(file);
  assert(reader.chunkIndexes.length > 2, "several chunks");
  assert.equal(reader.header.profile, "ros2");
  assert.match(reader.header.library, /^pliant \d/);
  assert.deepEqual(slice, [...Array(10).keys()].map((k) => 2_000_000_000n + BigInt(k) * 1_000_000n));
  for (const read of [front.topics, topics]) {
    checkValues(read, expected);
    checkRobot(read, expected);
    assert.deepEqual(read.metadata["pliant"], { scenario: "arm: {}\nμ: 1\n", seed: "7" });
    assert.deepEqual(read.metadata["pliant.statistics"], { dropped: "0", rows: "10300" });
  }
  const count = Object.values(topics.messages).reduce((n, messages) => n + messages.length, 0);
  assert.equal(reader.statistics.messageCount, BigInt(count));
  for (const type of ["Statistics", "ChunkIndex", "MetadataIndex", "SummaryOffset", "DataEnd", "Footer"])
    assert(front.topics.types.has(type), type);

  // A reader that checks finds a flipped bit.
  const bytes = new Uint8Array(await readFile(file));
  const { chunkStartOffset, chunkLength } = reader.chunkIndexes[1];
  bytes[Number(chunkStartOffset + chunkLength) - 100] ^= 1;
  const damaged = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  damaged.append(bytes);
  assert.throws(() => { while (damaged.nextRecord()); });
  console.log(`${count} messages on ${topics.channels.size} topics`);
}

async function checkKilled(file) {
  const { topics, whole, left } = await stream(file);
  assert(!whole);
  assert.equal(left, 0, "no half record");
  const rows = topics.messages["/count"];
  rows.forEach(({ time, message }, k) => {
    assert.equal(time, BigInt(k) * 1_000_000n);
    assert.equal(message.data, k);
  });
  assert(rows.length >= 200, `1 s lost at most: ${rows.length} of 1201 rows are there`);
  console.log(`${rows.length} of 1201 rows after SIGKILL`);
}

const [first, second] = process.argv.slice(2);
await (first === "--killed" ? checkKilled(second) : checkWhole(first, second));
