// SPDX-License-Identifier: Apache-2.0
// Reads an exported MCAP file with the reference reader and compares its estimates with a CSV file of replay.
// usage: node read_export.mjs EXPORTED_MCAP ESTIMATES_CSV
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";

const [path, csvPath] = process.argv.slice(2);
const bytes = new Uint8Array(readFileSync(path));
const decompressHandlers = {
  zstd: (data, size) => decompress(data, new Uint8Array(Number(size))),
};

// All checksums are right.
const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
stream.append(bytes);
while (stream.nextRecord());
assert.ok(stream.done());

const indexed = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.slice(Number(offset), Number(offset + length)),
  },
  decompressHandlers,
});
const readers = new Map();
for (const channel of indexed.channelsById.values()) {
  const schema = indexed.schemasById.get(channel.schemaId);
  assert.equal(schema.encoding, "ros2msg");
  assert.equal(channel.messageEncoding, "cdr");
  const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
  readers.set(channel.id, new MessageReader(definitions));
}
const messages = new Map(); // by topic
let last = 0n;
for await (const message of indexed.readMessages()) {
  const { topic } = indexed.channelsById.get(message.channelId);
  if (!messages.has(topic)) messages.set(topic, []);
  assert.ok(message.logTime >= last);
  last = message.logTime;
  messages.get(topic).push(readers.get(message.channelId).readMessage(message.data));
}

const [head, ...rows] = readFileSync(csvPath, "utf8").trimEnd().split("\n").map((line) => line.split(","));
const column = new Map(head.map((name, i) => [name, i]));
const estimates = messages.get("/jaw/estimate");
assert.equal(estimates.length, rows.length);
const provenances = ["", "assumed", "derived", "measured"];
const quantities = { position_m: "position", velocity_m_s: "velocity", acceleration_m_s2: "acceleration" };
let compared = 0;
const compare = (value, row, name) => {
  const text = row[column.get(name)];
  assert.ok(text === "" ? Number.isNaN(value) : value === Number(text), `${name}: ${value}, not ${text}`);
  ++compared;
};
const is_axis = column.has("x_position_m") === false;
rows.forEach((row, i) => {
  const { header } = estimates[i];
  assert.equal(header.stamp.sec * 1e9 + header.stamp.nsec, Math.round(Number(row[0]) * 1e9), `time of row ${i}`);
  for (const axis of is_axis ? ["axis"] : ["x", "y", "z"]) {
    const prefix = is_axis ? "" : axis + "_";
    compare(estimates[i][axis].measured_position_m, row, prefix + "measured_position_m");
    for (const [field, name] of Object.entries(quantities)) {
      const quantity = estimates[i][axis][field];
      compare(quantity.value, row, prefix + field);
      compare(quantity.standard_deviation, row, prefix + field.replace(name, name + "_sd"));
      assert.equal(provenances[quantity.provenance], row[column.get(prefix + name + "_provenance")]);
    }
  }
  assert.equal(estimates[i].events, row[column.get("events")]);
  assert.ok(Number.isNaN(estimates[i].mass_kg.value) && estimates[i].mass_kg.provenance === 0);
});

// The shapes that viewers know by name.
if (!is_axis) {
  const poses = messages.get("/jaw/pose");
  const transforms = messages.get("/tf");
  assert.equal(poses.length, rows.length);
  assert.equal(transforms.length, rows.length);
  poses.forEach(({ header, pose }, i) => {
    assert.equal(header.frame_id, "instrument");
    const { x, y, z, w } = pose.orientation;
    assert.ok(Math.abs(Math.hypot(x, y, z, w) - 1) < 1e-12);
    const jaw = transforms[i].transforms.find((transform) => transform.child_frame_id === "jaw");
    assert.deepEqual(jaw.transform.rotation, pose.orientation);
    assert.deepEqual({ ...jaw.transform.translation }, { ...pose.position });
    assert.equal(transforms[i].transforms.length, 4);
  });
}
console.log(`${path}: ${indexed.statistics.messageCount} messages; ${compared} numbers of ${rows.length} estimates are those of replay`);
