// From a message to the screen: fetch the original where it is wanted, decode, draw, ask for more.
import { DecoderFailed, type Decoder } from './decoder';
import { serverUrl } from './socket';
import type { Original, Shown } from './sweep';
import type { Settings } from './state';
import type { SweepMessage } from './wire';

const kMostWaiting = 4; // more than were asked for is the server's fault
const kMostLayers = 64;

export interface PipelineEvents {
  /** Whether it is of the stream that is looked at. */
  wants(sweep: SweepMessage): boolean;
  /** Draws it; resolves when that is done. */
  show(sweep: Shown): Promise<void>;
  damaged(sweep: SweepMessage, message: string): void;
  /** Nothing can be decoded here. */
  failed(message: string): void;
  lackOriginal(message: string): void;
  /** One sweep is done with, for good or ill. */
  done(): void;
}

export class Pipeline {
  private readonly waiting: SweepMessage[] = [];
  private busy = false;
  private connections = 0; // what came by one is not asked for again by the next
  private last: SweepMessage | null = null;
  private stale = false; // what is shown of it was made by other settings
  private drawn = Promise.resolve(); // the sweep before

  constructor(
    private readonly decoder: Decoder,
    private readonly settings: () => Readonly<Settings>,
    private readonly events: PipelineEvents,
  ) {}

  add(sweep: SweepMessage): void {
    this.waiting.push(sweep);
    if (this.waiting.length > kMostWaiting) {
      this.waiting.shift();
      this.events.done();
    }
    void this.work();
  }

  /** Forgets what has not been shown: the connection it came by is gone. */
  clear(): void {
    this.waiting.length = 0;
    this.connections += 1;
  }

  /** Decodes the sweep on the screen again, by other settings, unless another one comes first. */
  again(): void {
    this.stale = this.last !== null;
    void this.work();
  }

  private async work(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    for (;;) {
      const sweep = this.waiting.shift();
      const connection = this.connections;
      const done = () => {
        if (connection === this.connections) this.events.done();
      };
      if (!sweep && !(this.stale && this.last)) break;
      if (!sweep) await this.handle(this.last!, () => undefined);
      else if (this.events.wants(sweep)) await this.handle(sweep, done);
      else done();
    }
    this.busy = false;
  }

  // While a sweep is drawn the worker decodes the next one.
  private async handle(sweep: SweepMessage, done: () => void): Promise<void> {
    const { mode, sideBySide, fill } = this.settings();
    this.last = sweep;
    this.stale = false;
    const wanted = (mode === 'error' || sideBySide) && sweep.hasOriginal;
    const original = wanted ? await this.fetchOriginal(sweep) : null;
    try {
      const compare = mode === 'error' && original ? original.xyz : null;
      const decoded = await this.decoder.decode(sweep.frame, { fill, layers: kMostLayers }, compare);
      await this.drawn;
      this.drawn = this.events.show({ message: sweep, original, ...decoded }).then(done);
    } catch (error) {
      const message = error instanceof Error ? error.message : String(error);
      if (error instanceof DecoderFailed) this.events.failed(message);
      else this.events.damaged(sweep, message);
      done();
    }
  }

  private async fetchOriginal(sweep: SweepMessage): Promise<Original | null> {
    const url = serverUrl(`original/${sweep.index}`);
    url.searchParams.set('stream', String(sweep.stream));
    try {
      const answer = await fetch(url);
      if (!answer.ok) throw new Error(`HTTP ${answer.status}`);
      const fields = (answer.headers.get('X-Fields') ?? 'x y z').trim().split(/[\s,]+/);
      return readOriginal(await answer.arrayBuffer(), fields);
    } catch (error) {
      this.events.lackOriginal(error instanceof Error ? error.message : String(error));
      return null;
    }
  }
}

/** Records of floats, as many a point as there are fields, x, y and z first. */
export function readOriginal(data: ArrayBuffer, fields: string[]): Original {
  const step = Math.max(fields.length, 3);
  const values = new Float32Array(data, 0, Math.floor(data.byteLength / 4));
  const points = Math.floor(values.length / step);
  const xyz = new Float32Array(points * 3);
  const at = fields.indexOf('intensity');
  const intensity = at >= 3 ? new Float32Array(points) : null;
  for (let i = 0; i < points; ++i) {
    xyz.set(values.subarray(i * step, i * step + 3), i * 3);
    if (intensity) intensity[i] = values[i * step + at]!;
  }
  return { points, xyz, intensity };
}
