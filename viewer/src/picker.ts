// Finds the point under the pointer, and says what is known of it.
import { Matrix4, type PerspectiveCamera } from 'three';
import type { Pane, SweepScene } from './scene';
import type { Shown } from './sweep';

const kReach = 10; // pixels

/** The index of the nearest point within reach of (x, y) in the pane, or -1. */
export function pointUnder(pane: Pane, camera: PerspectiveCamera, x: number, y: number): number {
  if (!pane.cloud) return -1;
  camera.updateMatrixWorld();
  const m = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
  const { xyz, points } = pane.cloud;
  const sx = ((x - pane.x) / pane.width) * 2 - 1;
  const sy = 1 - (y / pane.height) * 2;
  const reach = kReach / pane.height * 2;
  const aspect = pane.width / pane.height;
  let best = -1;
  let least = Infinity;
  for (let i = 0; i < points; ++i) {
    const [px, py, pz] = [xyz[3 * i]!, xyz[3 * i + 1]!, xyz[3 * i + 2]!];
    const w = m[3]! * px + m[7]! * py + m[11]! * pz + m[15]!;
    if (!(w > 0.1)) continue;
    const dx = ((m[0]! * px + m[4]! * py + m[8]! * pz + m[12]!) / w - sx) * aspect;
    const dy = (m[1]! * px + m[5]! * py + m[9]! * pz + m[13]!) / w - sy;
    const off = Math.hypot(dx, dy);
    if (off > reach) continue;
    // Of points equally near to the pointer the one in front is meant.
    const cost = w * (1 + 4 * (off / reach));
    if (cost < least) {
      least = cost;
      best = i;
    }
  }
  return best;
}

/** What is known of point `i`, as label and number. */
function factsOf(shown: Shown, pane: Pane, i: number): [string, string][] {
  const cloud = pane.cloud!;
  const [x, y, z] = [cloud.xyz[3 * i]!, cloud.xyz[3 * i + 1]!, cloud.xyz[3 * i + 2]!];
  const facts: [string, string][] = [
    ['forward (x)', `${x.toFixed(3)} m`],
    ['left (y)', `${y.toFixed(3)} m`],
    ['up (z)', `${z.toFixed(3)} m`],
    ['range', `${Math.hypot(x, y, z).toFixed(3)} m`],
    ['direction', `${((Math.atan2(y, x) * 180) / Math.PI).toFixed(2)}° left`],
  ];
  const filled = cloud.filled?.[i] === 1;
  if (cloud.intensity && !filled) facts.push(['intensity', String(Number(cloud.intensity[i]!.toPrecision(5)))]);
  if (cloud.ring && !filled) facts.push(['ring', String(cloud.ring[i])]);
  if (cloud.timeNs && !filled) facts.push(['time in sweep', `${(cloud.timeNs[i]! / 1e6).toFixed(3)} ms`]);
  if (!pane.original && shown.errors) facts.push(['error', `${(shown.errors[i]! * 100).toFixed(2)} cm`]);
  if (!pane.original) facts.push(['', filled ? 'filled in, not measured' : 'measured']);
  return facts;
}

/** The card with a point's numbers, and the ring around the point. */
export class Picker {
  private picked: { index: number; original: boolean; shown: Shown } | null = null;

  constructor(
    private readonly scene: SweepScene,
    canvas: HTMLCanvasElement,
    private readonly card: HTMLElement,
    private readonly ring: HTMLElement,
  ) {
    let down: [number, number] = [0, 0];
    canvas.addEventListener('pointerdown', (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener('pointerup', (event) => {
      // A drag turns the view; a click picks.
      if (Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4 && event.button === 0) {
        const at = canvas.getBoundingClientRect();
        this.pick(event.clientX - at.left, event.clientY - at.top);
      }
    });
    canvas.addEventListener('drawn', () => this.place());
  }

  close(): void {
    this.picked = null;
    this.card.hidden = true;
    this.ring.hidden = true;
  }

  private pick(x: number, y: number): void {
    const shown = this.scene.newest;
    const pane = this.scene.panes().find((one) => x >= one.x && x < one.x + one.width);
    const index = shown && pane ? pointUnder(pane, this.scene.rig.camera, x, y) : -1;
    if (!shown || !pane || index < 0) {
      this.close();
      return;
    }
    this.picked = { index, original: pane.original, shown };
    this.card.querySelector('h2')!.textContent = `Point of sweep ${shown.message.index}`;
    const list = this.card.querySelector('dl')!;
    list.replaceChildren(
      ...factsOf(shown, pane, index).flatMap(([label, value]) => {
        const [term, detail] = [document.createElement('dt'), document.createElement('dd')];
        term.textContent = label;
        detail.textContent = value;
        return label ? [term, detail] : [Object.assign(document.createElement('dt'), { textContent: 'kind' }), detail];
      }),
    );
    this.card.hidden = false;
    this.place();
  }

  // The ring follows its point while the view turns. The next sweep has other points: then the
  // numbers stay, and the ring goes.
  private place(): void {
    if (!this.picked) return;
    const pane = this.scene.panes().find((one) => one.original === this.picked!.original);
    if (!pane?.cloud || this.scene.newest !== this.picked.shown) {
      this.ring.hidden = true;
      return;
    }
    const { xyz } = pane.cloud;
    const i = this.picked.index * 3;
    const camera = this.scene.rig.camera;
    const m = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    const along = (r: number) => m[r]! * xyz[i]! + m[r + 4]! * xyz[i + 1]! + m[r + 8]! * xyz[i + 2]! + m[r + 12]!;
    const w = along(3);
    this.ring.hidden = w <= 0;
    this.ring.style.left = `${pane.x + ((along(0) / w + 1) / 2) * pane.width}px`;
    this.ring.style.top = `${((1 - along(1) / w) / 2) * pane.height}px`;
  }
}
