// How each robot's link fares, over time; and the level, where the operator may choose it.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { byId, bytesText, countText, make } from './dom';
import { History, kQuantities, type Quantity } from './history';
import { LevelChoice } from './level_choice';
import type { Store } from './state';
import type { ClientMessage, Hello, RobotStatus } from './wire';

const kChartHeight = 104;
const kLines = { dark: ['#5cb8ff', '#ffb454', '#7ee787', '#ff8fa3', '#c9a0ff'], light: ['#0969da', '#b35900', '#1a7f37', '#c2255c', '#7a3ecf'] };
const kAxis = { dark: '#aab4c0', light: '#4a5562' };
const kGrid = { dark: '#2b323c', light: '#dde1e7' };

export class Dashboard {
  private readonly charts = new Map<Quantity, uPlot>();
  private readonly place = byId('charts');
  private readonly rows = byId('robots');
  private readonly choices = new Map<string, LevelChoice>();
  private drawn = ''; // which charts there are, of which robots
  private live = false;

  constructor(
    private readonly store: Store,
    private readonly history: History,
    private readonly send: (message: ClientMessage) => void,
  ) {
    store.watch((settings, changed) => {
      if (changed.has('dark')) this.drawn = '';
      if (settings.dashboard) this.update();
    });
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  begin(hello: Hello): void {
    this.live = hello.source === 'live';
    byId('dashboard-text').textContent =
      this.live ? 'How each link fares, once a second.' : 'A file has no link: this is what playing it brings to this page.';
    this.drawn = '';
    this.update();
  }

  /** Draws what the history has. */
  update(): void {
    if (!this.store.get().dashboard) return;
    const known = (Object.keys(kQuantities) as Quantity[]).filter((quantity) => this.history.has(quantity));
    const wanted = [...known, '/', ...this.history.robots].join(' ');
    if (wanted !== this.drawn) {
      this.drawn = wanted;
      this.rebuild(new Set(known));
    }
    for (const [quantity, chart] of this.charts) chart.setData(this.history.columns(quantity));
    this.showRobots();
  }

  /** A live link's quantities that nobody tells are named, too; a file has none of them. */
  private rebuild(known: Set<Quantity>): void {
    for (const chart of this.charts.values()) chart.destroy();
    this.charts.clear();
    this.place.replaceChildren();
    for (const quantity of Object.keys(kQuantities) as Quantity[]) {
      if (!known.has(quantity) && (!this.live || this.history.robots.length === 0)) continue;
      const info = kQuantities[quantity];
      const box = make('figure', { className: 'chart' });
      const caption = make('figcaption', { title: info.explanation }, make('b', {}, info.label), info.unit ? ` ${info.unit}` : '', make('span', {}, info.explanation));
      box.append(caption);
      this.place.append(box);
      if (!known.has(quantity)) {
        box.append(make('p', { className: 'unknown' }, 'not reported'));
        continue;
      }
      this.charts.set(quantity, new uPlot(this.options(box), this.history.columns(quantity), box));
    }
    this.showRows();
  }

  /** Rows stay where they can: somebody may be choosing a level in one. */
  private showRows(): void {
    const rows = new Map([...this.rows.querySelectorAll<HTMLElement>('li')].map((row) => [row.dataset['robot']!, row]));
    this.history.robots.forEach((robot, i) => {
      if (!rows.has(robot)) this.rows.append(this.robotRow(robot));
      this.rows.querySelectorAll<HTMLElement>('.swatch')[i]!.style.backgroundColor = this.colourOf(i);
    });
    for (const [robot, row] of rows) {
      if (this.history.robots.includes(robot)) continue;
      row.remove();
      this.choices.delete(robot);
    }
  }

  private options(box: HTMLElement): uPlot.Options {
    const theme = this.store.get().dark ? 'dark' : 'light';
    const axis = { stroke: kAxis[theme], grid: { stroke: kGrid[theme], width: 1 }, ticks: { show: false }, font: '11px system-ui' };
    return {
      width: Math.max(box.clientWidth, 120),
      height: kChartHeight,
      legend: { show: false },
      cursor: { sync: { key: 'dashboard' }, drag: { x: false, y: false } },
      scales: { y: { range: (_chart, low, high) => [Math.min(0, low ?? 0), Math.max(high ?? 1, 1e-3) * 1.08] } },
      axes: [
        { ...axis, size: 24, space: 60, values: (_chart, ticks) => ticks.map((tick) => clockText(tick)) },
        { ...axis, size: 44, space: 26 },
      ],
      series: [{}, ...this.history.robots.map((label, i) => ({ label, stroke: this.colourOf(i), width: 2, points: { show: false } }))],
    };
  }

  private colourOf(robot: number): string {
    const colours = kLines[this.store.get().dark ? 'dark' : 'light'];
    return colours[robot % colours.length]!;
  }

  private robotRow(robot: string): HTMLElement {
    const choice = new LevelChoice(robot, this.send);
    this.choices.set(robot, choice);
    const swatch = make('i', { className: 'swatch' });
    const row = make('li', {}, swatch, make('b', {}, robot || 'robot'), make('span', { className: 'facts' }), choice.element);
    row.dataset['robot'] = robot;
    return row;
  }

  private showRobots(): void {
    for (const row of this.rows.querySelectorAll<HTMLElement>('li')) {
      const robot = row.dataset['robot'] ?? '';
      const status = this.history.latest(robot);
      row.querySelector('.facts')!.textContent = status ? factsOf(status, this.live) : 'gone';
      this.choices.get(robot)?.show(status);
      row.classList.toggle('off', !status?.connected);
    }
  }

  private resize(): void {
    for (const [, chart] of this.charts) {
      const width = chart.root.parentElement!.clientWidth;
      if (width > 0 && width !== chart.width) chart.setSize({ width, height: kChartHeight });
    }
  }
}

function factsOf(status: RobotStatus, live: boolean): string {
  if (!status.connected) return 'not connected';
  const unknown = [status.level === null ? 'level' : '', status.queue_frames === null ? 'queue' : '', status.qoe === null ? 'QoE' : ''].filter(Boolean);
  const facts = [
    status.bytes_per_second === null ? '' : `${bytesText(status.bytes_per_second)}/s`,
    status.level === null ? '' : `level ${status.level}`,
    status.queue_frames === null ? '' : `queue ${countText(status.queue_frames)}${status.queue_bytes ? ` (${bytesText(status.queue_bytes)})` : ''}`,
    status.age_ms === null ? '' : `${Math.round(status.age_ms)} ms old`,
    status.drops === null ? '' : `${countText(status.drops)} dropped${status.sender_drops === null ? '' : `, ${countText(status.sender_drops)} before they left`}`,
    status.qoe === null ? '' : `QoE ${status.qoe.toFixed(1)}`,
    status.sweeps === null ? '' : `${countText(status.sweeps)} sweeps`,
    live && unknown.length > 0 ? `${unknown.join(', ')} not reported` : '',
  ];
  return facts.filter(Boolean).join(' · ');
}

function clockText(seconds: number): string {
  // A status may count from the epoch or from the start.
  if (seconds > 1e8) return new Date(seconds * 1000).toLocaleTimeString('en-GB');
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${String(Math.floor(seconds % 60)).padStart(2, '0')}`;
}
