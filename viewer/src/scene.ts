// The picture: sweeps, grid and axes, in one pane or two. Drawn when something has changed, never
// otherwise.
import { Color, Group, Scene, WebGLRenderer } from 'three';
import { CameraRig } from './camera';
import { Ground, makeAxes } from './ground';
import { PointsObject, PointStyle } from './points';
import { rangeOf, scalarsOf, type Mode } from './scalars';
import { asCloud, type Shown } from './sweep';
import type { Settings } from './state';
import type { Cloud } from './wasm_decoder';

const kGround = { dark: 0x0e1116, light: 0xf4f5f7 };

/** Few points are drawn larger, so that surfaces still read as such; smoothed, since each sweep has another number. */
function sparseness(points: number): number {
  return Math.min(Math.max(Math.sqrt(40_000 / Math.max(points, 1)), 1), 1.8);
}

/** Part of the canvas, in pixels of the page from its top left. */
export interface Pane {
  x: number;
  width: number;
  height: number;
  cloud: Cloud | null;
  original: boolean;
}

/** A sweep on the graphics card, and which of its quantities is there. */
interface Layer {
  shown: Shown;
  points: PointsObject;
  mode: Mode | null;
}

export class SweepScene {
  readonly rig: CameraRig;
  /** The range of colours in use. */
  range: [number, number] = [0, 1];
  /** Whether the newest sweep has what it should be coloured by. */
  hasValues = true;
  onRange: () => void = () => undefined;

  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly style = new PointStyle();
  private readonly sweeps: Layer[] = []; // newest first
  private readonly original = new PointsObject(this.style);
  private readonly decoded = new Group();
  private readonly ground = new Ground();
  private readonly axes = makeAxes();
  private pending = 0;
  private waiting: (() => void)[] = [];
  private sparse = 1; // how much larger than chosen points are drawn
  private smoothed: [number, number] | null = null;
  rateHz = 10;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private settings: Readonly<Settings>,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.autoClear = false;
    this.rig = new CameraRig(canvas, () => this.requestDraw());
    this.scene.add(this.decoded, this.original.object, this.ground.object, this.axes);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
  }

  /** The newest sweep, if any. */
  get newest(): Shown | null {
    return this.sweeps[0]?.shown ?? null;
  }

  /** Shows `sweep` as the newest; resolves once it has been drawn. */
  show(sweep: Shown): Promise<void> {
    const same = this.newest?.message.index === sweep.message.index && this.newest.message.stream === sweep.message.stream;
    const follows = sweep.message.index - (this.newest?.message.index ?? sweep.message.index);
    if (Math.abs(follows) > 3) this.smoothed = null; // elsewhere in the file
    const keep = this.settings.trail + 1;
    const spare = same ? this.sweeps.shift() : this.sweeps.length >= keep ? this.sweeps.pop() : undefined;
    const points = spare?.points ?? new PointsObject(this.style);
    if (!spare) this.decoded.add(points.object);
    this.sweeps.unshift({ shown: sweep, points, mode: null });
    this.trim();
    const sparse = sparseness(sweep.cloud.points);
    this.sparse = this.newest ? this.sparse + (sparse - this.sparse) * 0.3 : sparse;
    this.size();
    points.set(sweep.cloud.points, sweep.cloud.xyz, sweep.cloud.filled);
    if (sweep.original) this.original.set(sweep.original.points, sweep.original.xyz, null);
    this.colour();
    return this.requestDraw();
  }

  /** Takes all sweeps away. */
  clear(): void {
    for (const { points } of this.sweeps.splice(0)) this.drop(points);
    this.smoothed = null;
    void this.requestDraw();
  }

  apply(settings: Readonly<Settings>, changed: ReadonlySet<keyof Settings>): void {
    this.settings = settings;
    const { uniforms } = this.style;
    this.size();
    uniforms.nearest.value = settings.view === 'first' ? 1.4 : 2; // at the sensor all points are near
    if (changed.has('map') || changed.has('dark')) this.style.setMap(settings.map, settings.dark);
    if (changed.has('dark')) this.paintGround();
    if (changed.has('view')) this.rig.show(settings.view);
    if (changed.has('mode')) this.smoothed = null;
    if (changed.has('sideBySide')) this.resize();
    this.ground.object.visible = settings.grid;
    this.axes.visible = settings.axes && settings.view !== 'first';
    this.trim();
    this.colour();
    void this.requestDraw();
  }

  /** Resolves once the picture is up to date. */
  requestDraw(): Promise<void> {
    this.pending ||= requestAnimationFrame(() => {
      this.pending = 0;
      this.draw();
      for (const done of this.waiting.splice(0)) done();
    });
    return new Promise((resolve) => this.waiting.push(resolve));
  }

  /** What is drawn where: decoded alone, or the original to its left. */
  panes(): Pane[] {
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    const newest = this.newest;
    const decoded = newest?.cloud ?? null;
    if (!this.settings.sideBySide) return [{ x: 0, width, height, cloud: decoded, original: false }];
    const half = Math.floor(width / 2);
    const original = newest?.original ? asCloud(newest.original, newest.cloud) : null;
    return [
      { x: 0, width: half, height, cloud: original, original: true },
      { x: half, width: width - half, height, cloud: decoded, original: false },
    ];
  }

  draw(): void {
    this.rig.beforeDraw();
    this.renderer.setScissorTest(true);
    for (const pane of this.panes()) {
      this.decoded.visible = !pane.original;
      this.original.object.visible = pane.original && pane.cloud !== null;
      this.renderer.setViewport(pane.x, 0, pane.width, pane.height);
      this.renderer.setScissor(pane.x, 0, pane.width, pane.height);
      this.renderer.clear();
      this.renderer.render(this.scene, this.rig.camera);
    }
    this.canvas.dispatchEvent(new Event('drawn'));
  }

  /** Gives every point its number, and the colours their range. */
  colour(): void {
    const newest = this.newest;
    if (!newest) return;
    const { mode, range } = this.settings;
    const sweepS = 1 / this.rateHz;
    this.sweeps.forEach((layer, k) => {
      layer.points.setOpacity(k === 0 ? 1 : 0.55 * (1 - k / (this.settings.trail + 1)));
      if (layer.mode === mode && mode !== 'age') return; // what else a point has stays as it is
      const age = Math.max(0, newest.message.index - layer.shown.message.index) * sweepS;
      const values = scalarsOf(layer.shown, mode, age);
      if (k === 0) this.hasValues = values !== null;
      if (k === 0 && values) this.follow(rangeOf(values, mode));
      layer.points.setValues(values);
      layer.mode = mode;
    });
    if (newest.original) {
      const cloud = asCloud(newest.original, newest.cloud);
      const values = scalarsOf({ ...newest, cloud, errors: null }, mode, 0);
      this.original.setValues(values);
    }
    this.range = range ?? this.smoothed ?? [0, 1];
    this.style.uniforms.range.value.set(...this.range);
    this.onRange();
  }

  // Colours that follow every sweep at once would flicker.
  private follow([low, high]: [number, number]): void {
    if (this.settings.mode === 'age') high = Math.max(high, this.settings.trail / this.rateHz + 1 / this.rateHz);
    if (!this.smoothed) {
      this.smoothed = [low, high];
      return;
    }
    const [a, b] = this.smoothed;
    this.smoothed = [a + (low - a) * 0.2, b + (high - b) * 0.2];
  }

  private size(): void {
    this.style.uniforms.size.value = this.settings.pointSize * this.sparse * this.renderer.getPixelRatio();
  }

  private trim(): void {
    for (const { points } of this.sweeps.splice(this.settings.trail + 1)) this.drop(points);
  }

  private drop(points: PointsObject): void {
    this.decoded.remove(points.object);
    points.dispose();
  }

  private paintGround(): void {
    const { dark } = this.settings;
    this.renderer.setClearColor(new Color(dark ? kGround.dark : kGround.light));
    this.ground.paint(dark);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement!;
    this.renderer.setSize(width, height, false);
    this.rig.resize(this.settings.sideBySide ? width / 2 : width, height);
    void this.requestDraw();
  }
}
