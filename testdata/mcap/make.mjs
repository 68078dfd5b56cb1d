// make.mjs FOLDER: writes the recordings of this folder into FOLDER, with the writer of the format's
// authors. First, in any folder: npm install @mcap/core@2.2.2 @foxglove/rosmsg
// @foxglove/rosmsg2-serialization lz4js zstd-codec, and NODE_PATH or a copy of this file there.
import fs from "node:fs";
import path from "node:path";
import { createRequire } from "node:module";
const require = createRequire(path.join(process.cwd(), "x.js"));
const { McapWriter } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageWriter } = require("@foxglove/rosmsg2-serialization");
const lz4 = require("lz4js");
const { ZstdCodec } = require("zstd-codec");

const header = `================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
`;
const definitions = {
  "sensor_msgs/msg/JointState": `# State of a set of joints.
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
` + header,
  "std_msgs/msg/Float64": "float64 data\n",
  "geometry_msgs/msg/WrenchStamped": `std_msgs/Header header
Wrench wrench
================================================================================
MSG: geometry_msgs/Wrench
Vector3  force
Vector3  torque
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
` + header,
  "rig/msg/Mixed": `uint8 IDLE=0
bool ready
int8 small -5
string<=10 label "a#b"
uint16[3] fixed
float32[<=4] few
int64 large
Pair[] pairs
uint8[] picture
================================================================================
MSG: rig/Pair
float32 a
bool b
`,
};

class File {
  constructor(name) { this.fd = fs.openSync(name, "w"); this.at = 0; }
  position() { return BigInt(this.at); }
  async write(bytes) { fs.writeSync(this.fd, bytes); this.at += bytes.length; }
}

const begin = 1_773_680_691_000_000_000n;
const stamp = (ns) => ({ sec: Number(ns / 1_000_000_000n), nanosec: Number(ns % 1_000_000_000n) });

async function write(name, compression, compressChunk, samples = 40) {
  const writer = new McapWriter({ writable: new File(name), compressChunk, chunkSize: 2000 });
  await writer.start({ profile: "ros2", library: "make.mjs" });
  const channels = {};
  for (const [type, topic] of [
    ["sensor_msgs/msg/JointState", "/joint_states"],
    ["std_msgs/msg/Float64", "/current"],
    ["geometry_msgs/msg/WrenchStamped", "/wrench"],
    ["rig/msg/Mixed", "/mixed"],
  ]) {
    const schemaId = await writer.registerSchema({
      name: type, encoding: "ros2msg", data: new TextEncoder().encode(definitions[type]) });
    channels[topic] = {
      id: await writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata: new Map() }),
      writer: new MessageWriter(parse(definitions[type], { ros2: true })) };
  }
  const jsonId = await writer.registerChannel({
    schemaId: 0, topic: "/json", messageEncoding: "json", metadata: new Map() });
  const protoId = await writer.registerChannel({
    schemaId: 0, topic: "/proto", messageEncoding: "protobuf", metadata: new Map() });
  let sequence = 0;
  const add = (channelId, logTime, data) =>
    writer.addMessage({ channelId, sequence: sequence++, logTime, publishTime: logTime, data });
  for (let i = 0; i < samples; ++i) {
    const time = begin + BigInt(i) * 10_000_000n;
    const made = stamp(time - 1_000_000n);
    const names = i % 2 ? ["elbow", "wrist"] : ["wrist", "elbow"];
    const at = (name) => (name === "elbow" ? 0.1 * i : -0.2 * i);
    const send = (topic, message) =>
      add(channels[topic].id, time, channels[topic].writer.writeMessage(message));
    await send("/joint_states", {
      header: { stamp: made, frame_id: "base" }, name: names, position: names.map(at),
      velocity: i === 5 ? [] : names.map((n) => 2 * at(n)), effort: [] });
    if (i % 2 === 0) await send("/current", { data: 1.5 * i });
    await send("/wrench", {
      header: { stamp: { sec: 0, nanosec: 0 }, frame_id: "tool" },
      wrench: { force: { x: i, y: 2 * i, z: 3 * i }, torque: { x: 0, y: 0, z: -i } } });
    await send("/mixed", {
      ready: i > 3, small: -i, label: "x".repeat(i % 5), fixed: [i, i + 1, i + 2],
      few: i % 3 ? [0.5, i] : [0.5], large: 1n << 40n, pairs: [{ a: i, b: true }, { a: 2, b: false }],
      picture: new Uint8Array(100) });
    await add(jsonId, time, new TextEncoder().encode(JSON.stringify({
      header: { stamp: made }, q: [i, 2 * i], on: true, note: "n", deep: { tau: -0.5 * i } })));
    await add(protoId, time, new Uint8Array([8, 1]));
  }
  await writer.end();
}

const folder = process.argv[2] ?? ".";
const zstd = await new Promise((done) => ZstdCodec.run((codec) => done(new codec.Simple())));
await write(path.join(folder, "plain.mcap"), "");
await write(path.join(folder, "lz4.mcap"), "lz4", (data) =>
  ({ compression: "lz4", compressedData: lz4.compress(data) }));
await write(path.join(folder, "zstd.mcap"), "zstd", (data) =>
  ({ compression: "zstd", compressedData: zstd.compress(data) }));
