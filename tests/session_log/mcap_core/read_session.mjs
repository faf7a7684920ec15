// SPDX-License-Identifier: Apache-2.0
// Reads a session log with the reference MCAP reader and compares it with what was recorded.
// usage: node read_session.mjs LOG EXPECTED_JSON [cut]     (cut: the log has no end; the summary is not read)
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";

const [logPath, expectedPath, cut] = process.argv.slice(2);
const bytes = new Uint8Array(readFileSync(logPath));
const expected = JSON.parse(readFileSync(expectedPath, "utf8"));
const decompressHandlers = {
  zstd: (data, size) => decompress(data, new Uint8Array(Number(size))),
};

// What a log says, from records in any order of their kinds.
class Content {
  schemas = new Map();
  readers = new Map(); // by channel
  topics = new Map();
  messages = new Map(); // by topic
  attachments = new Map();
  session = {};

  take(record) {
    switch (record.type) {
      case "Schema":
        this.schemas.set(record.id, record);
        break;
      case "Channel": {
        const schema = this.schemas.get(record.schemaId);
        assert.equal(schema.encoding, "ros2msg");
        assert.equal(record.messageEncoding, "cdr");
        const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
        this.readers.set(record.id, new MessageReader(definitions));
        this.topics.set(record.id, record.topic);
        break;
      }
      case "Message": {
        const topic = this.topics.get(record.channelId);
        if (!this.messages.has(topic)) this.messages.set(topic, []);
        const list = this.messages.get(topic);
        assert.equal(record.sequence, list.length);
        list.push({ logTime: record.logTime, ...this.readers.get(record.channelId).readMessage(record.data) });
        break;
      }
      case "Attachment":
        this.attachments.set(record.name, Buffer.from(record.data).toString("hex"));
        break;
      case "Metadata":
        assert.equal(record.name, "condyle_session");
        this.session = Object.fromEntries(record.metadata);
        break;
    }
  }

  compare() {
    for (const [key, value] of Object.entries(expected.session)) assert.equal(this.session[key], value, key);
    for (const [name, hex] of Object.entries(expected.attachments)) assert.equal(this.attachments.get(name), hex, name);
    const offset = BigInt(this.session.start_wall_ns) - BigInt(this.session.start_monotonic_ns);
    let compared = 0;
    for (const [topic, list] of Object.entries(expected.messages)) {
      const found = this.messages.get(topic) ?? [];
      if (cut) assert.ok(found.length > 0 && found.length <= list.length, topic);
      else assert.equal(found.length, list.length, topic);
      found.forEach((message, i) => {
        const wanted = list[i];
        assert.equal(message.host_time_ns, BigInt(wanted.host_time_ns), topic);
        assert.equal(message.logTime, message.host_time_ns + offset, topic);
        if (wanted.data !== undefined) {
          assert.equal(Buffer.from(message.data).toString("hex"), wanted.data, topic);
        } else {
          assert.equal(message.kind, wanted.kind, topic);
          assert.equal(message.count, BigInt(wanted.count), topic);
          assert.equal(message.text, wanted.text, topic);
        }
        ++compared;
      });
    }
    assert.ok(compared > 0);
    return compared;
  }
}

// From start to end, all checksums checked.
const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
const streamed = new Content();
stream.append(bytes);
for (let record; (record = stream.nextRecord()); ) streamed.take(record);
assert.equal(stream.done(), !cut);
console.log(`stream reader: ${streamed.compare()} messages are as recorded${cut ? ", up to the cut" : ""}`);

// By the summary and the indices.
if (!cut) {
  const indexed = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, length) => bytes.slice(Number(offset), Number(offset + length)),
    },
    decompressHandlers,
  });
  const content = new Content();
  for (const schema of indexed.schemasById.values()) content.take(schema);
  for (const channel of indexed.channelsById.values()) content.take(channel);
  for await (const message of indexed.readMessages()) content.take(message);
  for await (const attachment of indexed.readAttachments()) content.take(attachment);
  for await (const metadata of indexed.readMetadata()) content.take(metadata);
  const compared = content.compare();
  assert.equal(indexed.statistics.messageCount, BigInt(compared));
  assert.equal(indexed.statistics.chunkCount, indexed.chunkIndexes.length);
  assert.ok(indexed.chunkIndexes.length > 2);
  for (const [id, topic] of content.topics) {
    assert.equal(indexed.statistics.channelMessageCounts.get(id), BigInt(expected.messages[topic].length), topic);
  }
  console.log(`indexed reader: ${compared} messages in ${indexed.chunkIndexes.length} chunks are as recorded`);
}
