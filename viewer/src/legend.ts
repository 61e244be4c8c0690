// What the colours mean: what is shown, from which number to which, and in which words.
import { kColourMaps, cssGradient, type ColourMapName } from './colour';
import { byId, make } from './dom';
import { kModes, type Mode } from './scalars';
import type { SweepScene } from './scene';
import type { Store } from './state';

function numberText(value: number): string {
  const size = Math.abs(value);
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : 2).replace(/\.0+$/, '');
}

export class Legend {
  private readonly mode = byId<HTMLSelectElement>('mode');
  private readonly bar = byId('legend-bar');
  private readonly low = byId<HTMLInputElement>('range-low');
  private readonly high = byId<HTMLInputElement>('range-high');
  private readonly auto = byId<HTMLInputElement>('range-auto');

  constructor(
    private readonly store: Store,
    private readonly scene: SweepScene,
  ) {
    const map = byId<HTMLSelectElement>('map');
    this.mode.append(...Object.entries(kModes).map(([value, info]) => make('option', { value, textContent: info.label })));
    map.append(...kColourMaps.map((value) => make('option', { value, textContent: value[0]!.toUpperCase() + value.slice(1) })));
    this.mode.addEventListener('change', () => store.set({ mode: this.mode.value as Mode, range: null }));
    map.addEventListener('change', () => store.set({ map: map.value as ColourMapName }));
    this.auto.addEventListener('change', () => store.set({ range: this.auto.checked ? null : [...this.scene.range] }));
    for (const input of [this.low, this.high]) {
      input.addEventListener('change', () => this.fix());
    }
    store.watch((settings, changed) => {
      this.mode.value = settings.mode;
      map.value = settings.map;
      this.auto.checked = settings.range === null;
      this.low.disabled = this.high.disabled = settings.range === null;
      if (changed.has('map') || changed.has('dark')) {
        this.bar.style.backgroundImage = cssGradient(settings.map, settings.dark);
      }
      byId('legend-filled').hidden = !settings.fill;
      this.update();
    });
    scene.onRange = () => this.update();
  }

  /** Shows the range in use. */
  update(): void {
    const { mode } = this.store.get();
    const info = kModes[mode];
    const [low, high] = this.scene.range;
    const unit = info.unit ? ` ${info.unit}` : '';
    byId('legend-low').textContent = numberText(low) + unit;
    byId('legend-high').textContent = numberText(high) + unit;
    byId('legend-text').textContent = this.scene.hasValues ? info.explanation : this.lack(mode);
    if (document.activeElement !== this.low) this.low.value = low.toFixed(2);
    if (document.activeElement !== this.high) this.high.value = high.toFixed(2);
  }

  private lack(mode: Mode): string {
    if (mode === 'error') {
      return this.scene.newest?.message.hasOriginal
        ? 'Comparing with the original …'
        : 'The server has no original of this sweep to compare with.';
    }
    return `These sweeps carry no ${kModes[mode].label.toLowerCase()}.`;
  }

  private fix(): void {
    const [low, high] = [Number(this.low.value), Number(this.high.value)];
    if (Number.isFinite(low) && Number.isFinite(high) && high > low) this.store.set({ range: [low, high] });
  }
}
