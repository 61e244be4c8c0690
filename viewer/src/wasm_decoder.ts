// The library's decoder, compiled to WebAssembly by ../wasm: a frame's bytes in, columns out.
// Runs in a worker of the page, and in node for the tests.
import { decompress as unpackZstd } from 'fzstd';

/** The points of one sweep, in columns; null where the frame does not carry one. */
export interface Cloud {
  points: number;
  xyz: Float32Array; // three a point, metres, in the sensor's frame: x forward, y left, z up
  intensity: Float32Array | null;
  ring: Uint16Array | null;
  timeNs: Float64Array | null; // since the sweep's first firing
  filled: Uint8Array | null; // 1: interpolated by the decoder, not measured
  width: number; // points in a row of an organised cloud, else 0
  sensor: string;
  codec: 'rcpcc' | 'beam' | 'unknown';
  sequence: number;
  stampS: number;
  counts: SweepCounts;
}

/** Where every input point went. */
export interface SweepCounts {
  pointsIn: number;
  pointsCoded: number;
  thinned: number;
}

export interface DecodeOptions {
  fill: boolean; // add what was left out, as interpolation has it
  layers: number; // decode so many at most, coarsest first
}

interface Exports {
  memory: WebAssembly.Memory;
  _initialize?: () => void;
  sweepcast_frame(size: number): number;
  sweepcast_decode(size: number, fill: number, layers: number): number;
}

// Words of the struct `DecodedSweep` in ../wasm/decoder.cpp.
const enum Word {
  ok,
  message,
  messageSize,
  points,
  xyz,
  intensity,
  ring,
  timeNs,
  filled,
  sensor,
  sensorSize,
  codec,
  width,
  pointsIn,
  pointsCoded,
  thinned = 20,
  sequence = 22, // as doubles
  stampS = 24,
}

/** A frame that does not decode; the message is the decoder's. */
export class DamagedFrame extends Error {}

export class WasmDecoder {
  private constructor(private readonly wasm: Exports) {}

  static async create(module: WebAssembly.Module): Promise<WasmDecoder> {
    let wasm: Exports | undefined;
    const unpack = (packed: number, packedSize: number, raw: number, rawSize: number): number => {
      if (!wasm) return -1;
      // The frame leaves out zstd's magic number.
      const whole = new Uint8Array(4 + packedSize);
      whole.set([0x28, 0xb5, 0x2f, 0xfd]);
      whole.set(new Uint8Array(wasm.memory.buffer, packed, packedSize), 4);
      try {
        const bytes = unpackZstd(whole, new Uint8Array(rawSize));
        if (bytes.length > rawSize) return -1;
        new Uint8Array(wasm.memory.buffer, raw, rawSize).set(bytes);
        return bytes.length;
      } catch {
        return -1;
      }
    };
    const imports: WebAssembly.Imports = {
      page: { unpack_zstd: unpack },
      env: { emscripten_notify_memory_growth: () => undefined },
      wasi_snapshot_preview1: {
        proc_exit: () => {
          throw new Error('the decoder ran out of memory');
        },
        clock_time_get: (_clock: number, _precision: bigint, at: number): number => {
          const nanoseconds = BigInt(Math.round(performance.now() * 1e6));
          new DataView(wasm!.memory.buffer).setBigUint64(at, nanoseconds, true);
          return 0;
        },
      },
    };
    const instance = await WebAssembly.instantiate(module, imports);
    wasm = instance.exports as unknown as Exports;
    wasm._initialize?.();
    return new WasmDecoder(wasm);
  }

  /** Throws `DamagedFrame`; any other error means that this decoder is of no more use. */
  decode(frame: Uint8Array, options: DecodeOptions): Cloud {
    const place = this.wasm.sweepcast_frame(frame.length) >>> 0;
    if (place === 0 && frame.length > 0) throw new DamagedFrame('the frame is larger than any frame may be');
    new Uint8Array(this.wasm.memory.buffer, place, frame.length).set(frame);
    const at = this.wasm.sweepcast_decode(frame.length, options.fill ? 1 : 0, options.layers) >>> 0;
    const memory = this.wasm.memory.buffer;
    const words = new Uint32Array(memory, at, 26);
    const doubles = new Float64Array(memory, at, 13);
    const text = (begin: Word, size: Word) =>
      new TextDecoder().decode(new Uint8Array(memory, words[begin]!, words[size]!).slice());
    if (words[Word.ok] !== 1) throw new DamagedFrame(text(Word.message, Word.messageSize));
    const points = words[Word.points]!;
    const column = <T>(word: Word, make: (address: number) => T): T | null =>
      words[word] === 0 ? null : make(words[word]!);
    return {
      points,
      xyz: new Float32Array(memory, words[Word.xyz]!, points * 3).slice(),
      intensity: column(Word.intensity, (from) => new Float32Array(memory, from, points).slice()),
      ring: column(Word.ring, (from) => new Uint16Array(memory, from, points).slice()),
      timeNs: column(Word.timeNs, (from) => Float64Array.from(new BigInt64Array(memory, from, points), Number)),
      filled: column(Word.filled, (from) => new Uint8Array(memory, from, points).slice()),
      sensor: text(Word.sensor, Word.sensorSize),
      codec: (['unknown', 'rcpcc', 'beam'] as const)[words[Word.codec]!] ?? 'unknown',
      width: words[Word.width]!,
      sequence: doubles[Word.sequence / 2]!,
      stampS: doubles[Word.stampS / 2]!,
      counts: {
        pointsIn: words[Word.pointsIn]!,
        pointsCoded: words[Word.pointsCoded]!,
        thinned: words[Word.thinned]!,
      },
    };
  }
}

/** The buffers of a cloud, to be handed over from the worker. */
export function buffersOf(cloud: Cloud): ArrayBuffer[] {
  return [cloud.xyz, cloud.intensity, cloud.ring, cloud.timeNs, cloud.filled]
    .filter((column) => column !== null)
    .map((column) => column.buffer as ArrayBuffer);
}
