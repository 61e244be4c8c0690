// What goes over the wire between page and server: docs/view.md. Nothing from outside is trusted:
// what cannot be right comes out as null.

/** One LiDAR of one robot. */
export interface StreamInfo {
  id: number;
  robot: string;
  sensor: string;
}

/** The first message, sent again whenever the streams change. */
export interface Hello {
  kind: 'hello';
  source: 'file' | 'live';
  title: string;
  rate_hz: number;
  frames: number | null;
  has_original: boolean;
  streams: StreamInfo[];
}

/** How a robot's link fares; null where unknown. */
export interface RobotStatus {
  name: string;
  connected: boolean;
  bytes_per_second: number | null;
  bytes_per_sweep: number | null;
  level: number | null;
  queue_frames: number | null;
  queue_bytes: number | null;
  age_ms: number | null;
  drops: number | null;
  sender_drops: number | null; // of these, those that never left
  qoe: number | null;
  sweeps: number | null;
  can_override: boolean; // its sender obeys when it is asked for a level
  override: number | null; // the level that was asked for and is sent
}

/** Once a second, live only. */
export interface LinkStatus {
  kind: 'status';
  time_s: number;
  robots: RobotStatus[];
}

/** Where a file is being played; after each change. */
export interface PlayState {
  kind: 'state';
  index: number;
  playing: boolean;
  speed: number;
  loop: boolean;
}

export interface Notice {
  kind: 'notice';
  level: 'info' | 'warning' | 'error';
  text: string;
}

export type ServerMessage = Hello | LinkStatus | PlayState | Notice;

/** What the page may ask for. */
export type ClientMessage =
  | { kind: 'more'; count: number }
  | { kind: 'play' }
  | { kind: 'pause' }
  | { kind: 'seek'; index: number }
  | { kind: 'speed'; value: number }
  | { kind: 'loop'; value: boolean }
  | { kind: 'override'; robot: string; level: number | null };

/** A sweep as it arrives: a frame and what the server knows of it. */
export interface SweepMessage {
  stream: number;
  hasOriginal: boolean;
  index: number;
  ageMs: number; // when it was sent
  layersPresent: number;
  layersMade: number;
  name: string;
  frame: Uint8Array;
}

type Json = Record<string, unknown>;

const text = (value: unknown): string => (typeof value === 'string' ? value : '');
const number = (value: unknown, otherwise: number): number =>
  typeof value === 'number' && Number.isFinite(value) ? value : otherwise;
const numberOrNull = (value: unknown): number | null =>
  typeof value === 'number' && Number.isFinite(value) ? value : null;
const objects = (value: unknown): Json[] =>
  Array.isArray(value) ? value.filter((item): item is Json => typeof item === 'object' && item !== null) : [];

function readHello(from: Json): Hello {
  const rate = number(from['rate_hz'], 10);
  return {
    kind: 'hello',
    source: from['source'] === 'live' ? 'live' : 'file',
    title: text(from['title']),
    rate_hz: rate > 0 ? rate : 10,
    frames: numberOrNull(from['frames']),
    has_original: from['has_original'] === true,
    streams: objects(from['streams']).map((stream) => ({
      id: number(stream['id'], 0),
      robot: text(stream['robot']),
      sensor: text(stream['sensor']),
    })),
  };
}

function readRobot(from: Json): RobotStatus {
  return {
    name: text(from['name']),
    connected: from['connected'] === true,
    bytes_per_second: numberOrNull(from['bytes_per_second']),
    bytes_per_sweep: numberOrNull(from['bytes_per_sweep']),
    level: numberOrNull(from['level']),
    queue_frames: numberOrNull(from['queue_frames']),
    queue_bytes: numberOrNull(from['queue_bytes']),
    age_ms: numberOrNull(from['age_ms']),
    drops: numberOrNull(from['drops']),
    sender_drops: numberOrNull(from['sender_drops']),
    qoe: numberOrNull(from['qoe']),
    sweeps: numberOrNull(from['sweeps']),
    can_override: from['can_override'] === true,
    override: numberOrNull(from['override']),
  };
}

/** Reads a text message; null where it is of no kind that this page knows. */
export function readText(data: string): ServerMessage | null {
  let from: Json;
  try {
    from = JSON.parse(data) as Json;
  } catch {
    return null;
  }
  switch (from?.['kind']) {
    case 'hello':
      return readHello(from);
    case 'status':
      return { kind: 'status', time_s: number(from['time_s'], 0), robots: objects(from['robots']).map(readRobot) };
    case 'state':
      return {
        kind: 'state',
        index: number(from['index'], 0),
        playing: from['playing'] === true,
        speed: number(from['speed'], 1),
        loop: from['loop'] === true,
      };
    case 'notice': {
      const level = from['level'];
      return { kind: 'notice', level: level === 'error' || level === 'warning' ? level : 'info', text: text(from['text']) };
    }
    default:
      return null;
  }
}

const kMagic = 0x31565753; // "SWV1", little endian
const kHeadBytes = 20;

/** Reads a sweep; null where the message is none. */
export function readSweep(data: ArrayBuffer): SweepMessage | null {
  if (data.byteLength < kHeadBytes) return null;
  const view = new DataView(data);
  const nameBytes = view.getUint16(6, true);
  if (view.getUint32(0, true) !== kMagic || kHeadBytes + nameBytes > data.byteLength) return null;
  return {
    stream: view.getUint8(4),
    hasOriginal: (view.getUint8(5) & 1) !== 0,
    index: view.getUint32(8, true),
    ageMs: view.getUint32(12, true),
    layersPresent: view.getUint16(16, true),
    layersMade: view.getUint16(18, true),
    name: new TextDecoder().decode(new Uint8Array(data, kHeadBytes, nameBytes)),
    frame: new Uint8Array(data, kHeadBytes + nameBytes),
  };
}
