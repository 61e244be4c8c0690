// Connects to a server as Foxglove does, with Foxglove's own client, and compares the clouds that
// come with those in a folder: node client.mjs PORT SUBPROTOCOL FOLDER [TOKEN]
// FOLDER holds what `sweepcast decode` makes of the recording that is served, as .bin files.
import foxglove from "@foxglove/ws-protocol";
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";
import { WebSocket } from "ws";

const [port, subprotocol, folder, token] = process.argv.slice(2);

/** The points of all clouds in the folder, as hexadecimal text. */
const expected = new Set(
  fs.readdirSync(folder).map((name) => fs.readFileSync(path.join(folder, name)).toString("hex")),
);
const seen = new Set();

const query = token === undefined ? "" : `?token=${token}`;
const socket = new WebSocket(`ws://127.0.0.1:${port}/${query}`, [subprotocol]);
const client = new foxglove.FoxgloveClient({ ws: socket });
const types = new Map();

client.on("error", (error) => {
  console.error(error);
  process.exit(1);
});
client.on("close", () => {
  console.error("closed before all clouds came");
  process.exit(1);
});
client.on("serverInfo", (info) => assert.match(info.name, /^sweepcast/));

client.on("advertise", (channels) => {
  assert.equal(socket.protocol, subprotocol);
  assert.equal(channels.length, 1);
  const [channel] = channels;
  assert.equal(channel.encoding, "protobuf");
  assert.equal(channel.schemaName, "foxglove.PointCloud");
  assert.match(channel.topic, /\/room\/points$/);
  const set = descriptor.FileDescriptorSet.decode(Buffer.from(channel.schema, "base64"));
  const type = protobuf.Root.fromDescriptor(set).resolveAll().lookupType(channel.schemaName);
  types.set(client.subscribe(channel.id), type);
});

client.on("message", ({ subscriptionId, timestamp, data }) => {
  assert.ok(timestamp > 1_600_000_000_000_000_000n);
  const cloud = types.get(subscriptionId).decode(new Uint8Array(data.buffer, data.byteOffset, data.byteLength));
  assert.equal(cloud.frame_id, "room");
  assert.equal(cloud.pose.orientation.w, 1);
  assert.equal(cloud.point_stride, 16);
  assert.deepEqual(
    cloud.fields.map(({ name, offset, type }) => [name, offset, type]),
    [
      ["x", 0, 7],
      ["y", 4, 7],
      ["z", 8, 7],
      ["intensity", 12, 7],
    ],
  );
  const points = Buffer.from(cloud.data).toString("hex");
  assert.ok(expected.has(points), "a cloud that the native decoder does not give");
  seen.add(points);
  if (seen.size < expected.size) return;
  console.log(`${seen.size} clouds`);
  process.exit(0);
});
