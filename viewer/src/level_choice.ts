// Where the operator asks a robot for a level, if that robot's sender obeys.
import { make } from './dom';
import type { ClientMessage, RobotStatus } from './wire';

const kLevels = 6;
const kPatienceMs = 4000; // what was asked for stays shown so long, until the robot says that it obeys

const valueOf = (level: number | null) => (level === null ? '' : String(level));

export class LevelChoice {
  readonly element: HTMLElement;
  private readonly select: HTMLSelectElement;
  private readonly outcome = make('span', { className: 'outcome' });
  private asked: { value: string; at: number } | null = null;

  constructor(robot: string, send: (message: ClientMessage) => void) {
    const hintOf = (level: number) => (level === 0 ? ' (finest)' : level === kLevels - 1 ? ' (smallest)' : '');
    const levels = Array.from({ length: kLevels }, (_, level) => make('option', { value: String(level) }, `${level}${hintOf(level)}`));
    this.select = make('select', {}, make('option', { value: '' }, 'automatic'), ...levels);
    this.outcome.setAttribute('role', 'status');
    const named = make('span', { className: 'hidden' }, ` of ${robot}`);
    this.element = make('div', { className: 'level-choice', hidden: true }, make('label', {}, 'Level', named, ' ', this.select), this.outcome);
    this.select.addEventListener('change', () => {
      const { value } = this.select;
      this.asked = { value, at: performance.now() };
      this.outcome.textContent = 'asked …';
      send({ kind: 'override', robot, level: value === '' ? null : Number(value) });
    });
  }

  /** Shows what the robot says it sends, but not over what has just been asked for. */
  show(status: RobotStatus | null): void {
    const offered = status !== null && status.connected && status.can_override;
    this.element.hidden = !offered;
    if (!offered) {
      this.asked = null;
      this.outcome.textContent = '';
      return;
    }
    const value = valueOf(status.override);
    if (this.asked && this.asked.value !== value && performance.now() - this.asked.at < kPatienceMs) return;
    if (this.asked) this.outcome.textContent = this.asked.value === value ? '' : 'the robot did not follow';
    this.asked = null;
    if (this.select.value !== value) this.select.value = value; // a list that is open stays as it is
  }
}
