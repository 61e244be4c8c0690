// How each robot's link fares, over time; and the level, where the operator may choose it.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { byId, bytesText, countText, make } from './dom';
import { History, kQuantities, type Quantity } from './history';
import type { Store } from './state';
import type { ClientMessage, Hello, RobotStatus } from './wire';

const kChartHeight = 104;
const kLevels = 6;
const kLines = { dark: ['#5cb8ff', '#ffb454', '#7ee787', '#ff8fa3', '#c9a0ff'], light: ['#0969da', '#b35900', '#1a7f37', '#c2255c', '#7a3ecf'] };
const kAxis = { dark: '#aab4c0', light: '#4a5562' };
const kGrid = { dark: '#2b323c', light: '#dde1e7' };

export class Dashboard {
  private readonly charts = new Map<Quantity, uPlot>();
  private readonly place = byId('charts');
  private readonly rows = byId('robots');
  private readonly overrides = new Map<string, HTMLSelectElement>();
  private drawn = ''; // which charts there are, of which robots
  private canOverride = false;

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
    this.canOverride = hello.can_override;
    byId('dashboard-text').textContent =
      hello.source === 'live' ? 'How each link fares, once a second.' : 'A file has no link: this is what playing it brings to this page.';
    this.drawn = '';
    this.update();
  }

  /** Draws what the history has. */
  update(): void {
    if (!this.store.get().dashboard) return;
    const quantities = (Object.keys(kQuantities) as Quantity[]).filter((quantity) => this.history.has(quantity));
    const wanted = [...quantities, '/', ...this.history.robots].join(' ');
    if (wanted !== this.drawn) {
      this.drawn = wanted;
      this.rebuild(quantities);
    }
    for (const [quantity, chart] of this.charts) chart.setData(this.history.columns(quantity));
    this.showRobots();
  }

  private rebuild(quantities: Quantity[]): void {
    for (const chart of this.charts.values()) chart.destroy();
    this.charts.clear();
    this.place.replaceChildren();
    for (const quantity of quantities) {
      const info = kQuantities[quantity];
      const box = make('figure', { className: 'chart' });
      const caption = make('figcaption', { title: info.explanation }, make('b', {}, info.label), info.unit ? ` ${info.unit}` : '', make('span', {}, info.explanation));
      box.append(caption);
      this.place.append(box);
      this.charts.set(quantity, new uPlot(this.options(box), this.history.columns(quantity), box));
    }
    this.overrides.clear();
    this.rows.replaceChildren(...this.history.robots.map((robot, i) => this.robotRow(robot, i)));
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

  private robotRow(robot: string, i: number): HTMLElement {
    const swatch = make('i', { className: 'swatch' });
    swatch.style.backgroundColor = this.colourOf(i);
    const row = make('li', {}, swatch, make('b', {}, robot || 'robot'), make('span', { className: 'facts' }));
    row.dataset['robot'] = robot;
    if (this.canOverride) row.append(this.override(robot));
    return row;
  }

  private override(robot: string): HTMLElement {
    const select = make('select', { ariaLabel: `Level of ${robot}` }, make('option', { value: '' }, 'Level: automatic'));
    for (let level = 0; level < kLevels; ++level) {
      const hint = level === 0 ? ' (finest)' : level === kLevels - 1 ? ' (smallest)' : '';
      select.append(make('option', { value: String(level) }, `Level: ${level}${hint}`));
    }
    select.addEventListener('change', () => {
      this.send({ kind: 'override', robot, level: select.value === '' ? null : Number(select.value) });
    });
    this.overrides.set(robot, select);
    return select;
  }

  private showRobots(): void {
    for (const row of this.rows.querySelectorAll<HTMLElement>('li')) {
      const status = this.history.latest(row.dataset['robot'] ?? '');
      row.querySelector('.facts')!.textContent = status ? factsOf(status) : 'gone';
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

function factsOf(status: RobotStatus): string {
  if (!status.connected) return 'not connected';
  const facts = [
    status.bytes_per_second === null ? '' : `${bytesText(status.bytes_per_second)}/s`,
    status.level === null ? '' : `level ${status.level}`,
    status.age_ms === null ? '' : `${Math.round(status.age_ms)} ms old`,
    status.drops === null ? '' : `${countText(status.drops)} dropped`,
    status.sweeps === null ? '' : `${countText(status.sweeps)} sweeps`,
  ];
  return facts.filter(Boolean).join(' · ');
}

function clockText(seconds: number): string {
  // A status may count from the epoch or from the start.
  if (seconds > 1e8) return new Date(seconds * 1000).toLocaleTimeString('en-GB');
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${String(Math.floor(seconds % 60)).padStart(2, '0')}`;
}
