// The keys, and the card that lists them.
import { byId, make } from './dom';
import { kModes, type Mode } from './scalars';
import type { Store } from './state';

export interface KeyActions {
  playOrPause(): void;
  step(by: number): void;
  seek(to: 'begin' | 'end'): void;
  faster(by: 1 | -1): void;
  resetView(): void;
  screenshot(): void;
  escape(): void;
}

interface Key {
  keys: string[]; // as the browser names them
  shown: string;
  meaning: string;
  act(event: KeyboardEvent): void;
}

function nextMode(store: Store, by: number): void {
  const modes = Object.keys(kModes) as Mode[];
  const at = modes.indexOf(store.get().mode);
  store.set({ mode: modes[(at + by + modes.length) % modes.length]!, range: null });
}

function keysOf(store: Store, actions: KeyActions, help: HTMLDialogElement): Key[] {
  const key = (keys: string[], shown: string, meaning: string, act: Key['act']): Key => ({ keys, shown, meaning, act });
  return [
    key([' '], 'Space', 'play or pause (files)', () => actions.playOrPause()),
    key(['ArrowLeft'], '←', 'one sweep back; with Shift ten', (e) => actions.step(e.shiftKey ? -10 : -1)),
    key(['ArrowRight'], '→', 'one sweep on; with Shift ten', (e) => actions.step(e.shiftKey ? 10 : 1)),
    key(['Home'], 'Home', 'to the first sweep', () => actions.seek('begin')),
    key(['End'], 'End', 'to the last sweep', () => actions.seek('end')),
    key(['+', '='], '+', 'faster', () => actions.faster(1)),
    key(['-'], '−', 'slower', () => actions.faster(-1)),
    key(['1'], '1', 'orbit: from the side', () => store.set({ view: 'orbit' })),
    key(['2'], '2', 'follow: from behind', () => store.set({ view: 'follow' })),
    key(['3'], '3', 'top: from above', () => store.set({ view: 'top' })),
    key(['4'], '4', 'first person: from the sensor', () => store.set({ view: 'first' })),
    key(['r'], 'R', 'view as it was', () => actions.resetView()),
    key(['c'], 'C', 'colour by the next quantity', () => nextMode(store, 1)),
    key(['f'], 'F', 'fill in what was left out', () => store.toggle('fill')),
    key(['o'], 'O', 'original beside decoded', () => {
      if (!byId('side-row').hidden) store.toggle('sideBySide');
    }),
    key(['t'], 'T', 'trail of earlier sweeps', () => store.set({ trail: store.get().trail > 0 ? 0 : 5 })),
    key(['g'], 'G', 'grid', () => store.toggle('grid')),
    key(['a'], 'A', 'axes', () => store.toggle('axes')),
    key(['d'], 'D', 'dashboard', () => store.toggle('dashboard')),
    key(['s'], 'S', 'settings', () => store.toggle('settings')),
    key(['l'], 'L', 'light or dark', () => store.toggle('dark')),
    key(['p'], 'P', 'save a picture', () => actions.screenshot()),
    key(['?'], '?', 'this card', () => (help.open ? help.close() : help.showModal())),
  ];
}

export function listenForKeys(store: Store, actions: KeyActions): void {
  const help = byId<HTMLDialogElement>('help');
  const keys = keysOf(store, actions, help);
  byId('keys').replaceChildren(
    ...keys.map(({ shown, meaning }) => make('div', {}, make('dt', {}, make('kbd', {}, shown)), make('dd', {}, meaning))),
  );
  byId('open-help').addEventListener('click', () => help.showModal());
  help.querySelector('.close')!.addEventListener('click', () => help.close());
  help.addEventListener('click', (event) => {
    if (event.target === help) help.close(); // beside the card
  });
  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === 'Escape') actions.escape();
    const target = event.target as HTMLElement;
    const typing = target.matches('input[type=number], select');
    const sliding = target.matches('input[type=range]') && /^(Arrow|Home|End|Page)/.test(event.key);
    const pressing = target.matches('button, input[type=checkbox]') && (event.key === ' ' || event.key === 'Enter');
    if (typing || sliding || pressing || (help.open && event.key !== '?')) return;
    const wanted = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const found = keys.find((key) => key.keys.includes(wanted));
    if (!found) return;
    event.preventDefault();
    found.act(event);
  });
}
