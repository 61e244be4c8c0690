// Buttons, boxes and sliders that change what is shown, each tied to one setting.
import { byId, make } from './dom';
import type { Settings, Store, View } from './state';
import type { StreamInfo } from './wire';

type Switch = 'grid' | 'axes' | 'fill' | 'sideBySide';

function tieSwitch(store: Store, id: string, key: Switch): void {
  const box = byId<HTMLInputElement>(id);
  box.addEventListener('change', () => store.set({ [key]: box.checked } as Partial<Settings>));
  store.watch((settings) => (box.checked = settings[key]));
}

function tieSlider(store: Store, id: string, key: 'pointSize' | 'trail'): void {
  const slider = byId<HTMLInputElement>(id);
  const output = byId<HTMLOutputElement>(`${id}-value`);
  slider.addEventListener('input', () => store.set({ [key]: Number(slider.value) }));
  store.watch((settings) => {
    slider.value = String(settings[key]);
    output.textContent = String(settings[key]);
  });
}

function tiePanel(store: Store, button: string, panel: string, key: 'settings' | 'dashboard'): void {
  const opener = byId<HTMLButtonElement>(button);
  const body = byId(panel);
  opener.addEventListener('click', () => store.toggle(key));
  body.querySelector('.close')?.addEventListener('click', () => {
    store.set({ [key]: false });
    opener.focus();
  });
  store.watch((settings) => {
    body.hidden = !settings[key];
    opener.setAttribute('aria-expanded', String(settings[key]));
  });
}

export class Controls {
  private readonly stream = byId<HTMLSelectElement>('stream');

  constructor(private readonly store: Store) {
    tieSwitch(store, 'grid', 'grid');
    tieSwitch(store, 'axes', 'axes');
    tieSwitch(store, 'fill', 'fill');
    tieSwitch(store, 'side', 'sideBySide');
    tieSlider(store, 'size', 'pointSize');
    tieSlider(store, 'trail', 'trail');
    tiePanel(store, 'open-settings', 'settings', 'settings');
    tiePanel(store, 'open-dashboard', 'dashboard', 'dashboard');
    for (const button of document.querySelectorAll<HTMLButtonElement>('#views button')) {
      const view = button.dataset['view'] as View;
      button.addEventListener('click', () => store.set({ view }));
      store.watch((settings) => button.setAttribute('aria-pressed', String(settings.view === view)));
    }
    const theme = byId<HTMLButtonElement>('theme');
    theme.addEventListener('click', () => store.toggle('dark'));
    store.watch((settings) => {
      document.documentElement.dataset['theme'] = settings.dark ? 'dark' : 'light';
      theme.setAttribute('aria-label', settings.dark ? 'Light colours' : 'Dark colours');
      theme.title = `${settings.dark ? 'Light' : 'Dark'} colours (L)`;
    });
    this.stream.addEventListener('change', () => store.set({ stream: Number(this.stream.value) }));
  }

  /** Offers these streams; one alone is no choice. */
  offer(streams: StreamInfo[], hasOriginal: boolean): void {
    this.stream.replaceChildren(
      ...streams.map(({ id, robot, sensor }) =>
        make('option', { value: String(id), textContent: [robot, sensor].filter(Boolean).join(' / ') || `stream ${id}` }),
      ),
    );
    const known = streams.some(({ id }) => id === this.store.get().stream);
    if (!known && streams[0]) this.store.set({ stream: streams[0].id });
    this.stream.value = String(this.store.get().stream);
    byId('stream-row').hidden = streams.length < 2;
    byId('side-row').hidden = !hasOriginal;
    if (!hasOriginal) this.store.set({ sideBySide: false });
  }
}
