// Play, pause, step, scrub and speed, for files.
import { byId } from './dom';
import type { ClientMessage, PlayState } from './wire';

const kSeekMs = 2000; // a sought sweep comes sooner, unless it is damaged
const kSpeeds = [0.25, 0.5, 1, 2, 4];

export class Transport {
  private readonly bar = byId('transport');
  private readonly play = byId<HTMLButtonElement>('play');
  private readonly slider = byId<HTMLInputElement>('scrub');
  private readonly loop = byId<HTMLButtonElement>('loop');
  private readonly speed = byId<HTMLSelectElement>('speed');
  private state: PlayState = { kind: 'state', index: 0, playing: false, speed: 1, loop: false };
  private frames = 0;
  private scrubbing = false;
  private soughtUntil = 0; // what was on its way before the sought sweep does not move the place

  constructor(private readonly send: (message: ClientMessage) => void) {
    this.play.addEventListener('click', () => this.toggle());
    byId('back').addEventListener('click', () => this.step(-1));
    byId('forward').addEventListener('click', () => this.step(1));
    this.slider.addEventListener('input', () => {
      this.scrubbing = true;
      this.seek(Number(this.slider.value));
    });
    this.slider.addEventListener('change', () => (this.scrubbing = false));
    this.loop.addEventListener('click', () => this.send({ kind: 'loop', value: !this.state.loop }));
    this.speed.addEventListener('change', () => this.send({ kind: 'speed', value: Number(this.speed.value) }));
  }

  /** Where the file is, to come back to after a lost connection. */
  get position(): PlayState {
    return this.state;
  }

  /** `frames`: how many the file has; null where there is no file. */
  setFrames(frames: number | null): void {
    this.bar.hidden = frames === null;
    this.frames = frames ?? 0;
    this.slider.max = String(Math.max(0, this.frames - 1));
    this.show();
  }

  setState(state: PlayState): void {
    const index = performance.now() < this.soughtUntil ? this.state.index : state.index; // it may answer what came before
    this.state = { ...state, index };
    this.show();
  }

  /** A sweep is on the screen. */
  setShown(index: number): void {
    if (this.bar.hidden) return;
    if (index !== this.state.index && performance.now() < this.soughtUntil) return;
    this.soughtUntil = 0;
    this.state = { ...this.state, index };
    this.show();
  }

  toggle(): void {
    if (this.bar.hidden) return;
    const atEnd = !this.state.playing && this.state.index >= this.frames - 1;
    if (atEnd) this.send({ kind: 'seek', index: 0 });
    this.send({ kind: this.state.playing ? 'pause' : 'play' });
  }

  step(by: number): void {
    if (this.bar.hidden) return;
    if (this.state.playing) this.send({ kind: 'pause' });
    this.seek(this.state.index + by);
  }

  seek(index: number): void {
    if (this.bar.hidden) return;
    const place = Math.min(Math.max(index, 0), this.frames - 1);
    this.state = { ...this.state, index: place };
    this.soughtUntil = performance.now() + kSeekMs;
    this.send({ kind: 'seek', index: place });
    this.show();
  }

  faster(by: 1 | -1): void {
    const at = kSpeeds.findIndex((speed) => speed >= this.state.speed);
    const value = kSpeeds[Math.min(Math.max(at + by, 0), kSpeeds.length - 1)]!;
    if (!this.bar.hidden) this.send({ kind: 'speed', value });
  }

  private show(): void {
    const { index, playing, speed, loop } = this.state;
    if (!this.scrubbing) this.slider.value = String(index);
    this.slider.setAttribute('aria-valuetext', `sweep ${index + 1} of ${this.frames}`);
    byId('place').textContent = `${index + 1} / ${this.frames}`;
    this.play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    this.play.classList.toggle('playing', playing);
    this.loop.setAttribute('aria-pressed', String(loop));
    if (kSpeeds.includes(speed)) this.speed.value = String(speed);
  }
}
