// The line on top that says what is wrong, and goes when it no longer is.
import { byId, make } from './dom';

type Level = 'info' | 'warning' | 'error';
/** Who says it: each has one line at a time. */
type Source = 'connection' | 'stall' | 'frame' | 'server' | 'page';

const kPassingMs = 8000;

export class Banner {
  private readonly place = byId('banner');
  private readonly lines = new Map<Source, HTMLElement>();
  private readonly timers = new Map<Source, ReturnType<typeof setTimeout>>();

  /** Says `text`; `passing`: only for a while. */
  say(source: Source, level: Level, text: string, passing = false): void {
    let line = this.lines.get(source);
    if (!line) {
      const close = make('button', { className: 'close', type: 'button', ariaLabel: 'Dismiss' }, '×');
      close.addEventListener('click', () => this.clear(source));
      line = make('div', {}, make('span'), close);
      this.lines.set(source, line);
      this.place.append(line);
    }
    line.className = `line ${level}`;
    const words = line.querySelector('span')!;
    if (words.textContent !== text) words.textContent = text;
    clearTimeout(this.timers.get(source));
    if (passing) this.timers.set(source, setTimeout(() => this.clear(source), kPassingMs));
  }

  clear(source: Source): void {
    this.lines.get(source)?.remove();
    this.lines.delete(source);
    clearTimeout(this.timers.get(source));
  }
}
