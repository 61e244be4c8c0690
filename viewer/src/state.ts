// What the user has chosen, in one place; whoever depends on it is told of changes.
import type { ColourMapName } from './colour';
import type { Mode } from './scalars';

export type View = 'orbit' | 'follow' | 'top' | 'first';

export interface Settings {
  mode: Mode;
  map: ColourMapName;
  range: [number, number] | null; // of the colours; null: follows the points
  view: View;
  pointSize: number; // pixels
  trail: number; // earlier sweeps that stay
  grid: boolean;
  axes: boolean;
  fill: boolean;
  sideBySide: boolean;
  stream: number;
  dark: boolean;
  dashboard: boolean;
  settings: boolean;
}

type Listener = (settings: Readonly<Settings>, changed: ReadonlySet<keyof Settings>) => void;

export class Store {
  private readonly listeners: Listener[] = [];

  constructor(private readonly current: Settings) {}

  get(): Readonly<Settings> {
    return this.current;
  }

  set(change: Partial<Settings>): void {
    // There is room for one panel.
    if (change.settings) change = { ...change, dashboard: false };
    if (change.dashboard) change = { ...change, settings: false };
    const changed = new Set<keyof Settings>();
    for (const key of Object.keys(change) as (keyof Settings)[]) {
      if (this.current[key] !== change[key]) changed.add(key);
    }
    if (changed.size === 0) return;
    Object.assign(this.current, change);
    for (const listener of this.listeners) listener(this.current, changed);
  }

  toggle(key: 'grid' | 'axes' | 'fill' | 'sideBySide' | 'dark' | 'dashboard' | 'settings'): void {
    this.set({ [key]: !this.current[key] });
  }

  /** Calls `listener` now, as if everything had changed, and after each change. */
  watch(listener: Listener): void {
    this.listeners.push(listener);
    listener(this.current, new Set(Object.keys(this.current) as (keyof Settings)[]));
  }
}

export function firstSettings(): Settings {
  return {
    mode: 'height',
    map: 'turbo',
    range: null,
    view: 'follow',
    pointSize: 2,
    trail: 0,
    grid: true,
    axes: true,
    fill: false,
    sideBySide: false,
    stream: 0,
    dark: !matchMedia('(prefers-color-scheme: light)').matches,
    dashboard: false,
    settings: false,
  };
}
