// The last minutes of every robot's link, as the dashboard draws them.
import type { RobotStatus } from './wire';

export type Quantity = 'bandwidth' | 'bytes' | 'level' | 'queue' | 'age' | 'drops' | 'qoe';

export interface QuantityInfo {
  label: string;
  unit: string;
  explanation: string;
  of(status: RobotStatus): number | null;
}

const scaled = (value: number | null, by: number) => (value === null ? null : value * by);

export const kQuantities: Record<Quantity, QuantityInfo> = {
  bandwidth: { label: 'Bandwidth', unit: 'kbit/s', explanation: 'What arrives each second', of: (s) => scaled(s.bytes_per_second, 0.008) },
  bytes: { label: 'Bytes a sweep', unit: 'kB', explanation: 'What one sweep takes', of: (s) => scaled(s.bytes_per_sweep, 0.001) },
  level: { label: 'Level', unit: '', explanation: 'Quality: 0 is the finest', of: (s) => s.level },
  queue: { label: 'Queue', unit: 'sweeps', explanation: 'Encoded and not yet sent', of: (s) => s.queue_frames },
  age: { label: 'Age', unit: 'ms', explanation: 'From measured to here', of: (s) => s.age_ms },
  drops: { label: 'Drops', unit: 'sweeps', explanation: 'Lost so far', of: (s) => s.drops },
  qoe: { label: 'QoE', unit: '', explanation: 'Quality of experience: higher is better', of: (s) => s.qoe },
};

const kMostSeconds = 600;

type Row = Map<string, RobotStatus>;

export class History {
  private readonly times: number[] = [];
  private readonly rows: Row[] = [];
  robots: string[] = [];

  add(timeS: number, robots: RobotStatus[]): void {
    if (this.times.length > 0 && timeS <= this.times[this.times.length - 1]!) this.clear(); // another server
    this.times.push(timeS);
    this.rows.push(new Map(robots.map((robot) => [robot.name, robot])));
    for (const { name } of robots) {
      if (!this.robots.includes(name)) this.robots = [...this.robots, name];
    }
    while (this.times.length > kMostSeconds) {
      this.times.shift();
      this.rows.shift();
    }
  }

  clear(): void {
    this.times.length = 0;
    this.rows.length = 0;
    this.robots = [];
  }

  latest(robot: string): RobotStatus | null {
    return this.rows[this.rows.length - 1]?.get(robot) ?? null;
  }

  /** Times, then one column a robot, as uPlot takes them. */
  columns(quantity: Quantity): [number[], ...(number | null)[][]] {
    const { of } = kQuantities[quantity];
    const columns = this.robots.map((robot) =>
      this.rows.map((row) => {
        const status = row.get(robot);
        return status ? of(status) : null;
      }),
    );
    return [this.times, ...columns];
  }

  has(quantity: Quantity): boolean {
    return this.columns(quantity).slice(1).some((column) => column.some((value) => value !== null));
  }
}

/** Makes a status out of what the page itself sees, for files, once a second. */
export class LocalMeter {
  private bytes = 0;
  private sweeps = 0;
  private total = 0;

  add(bytes: number): void {
    this.bytes += bytes;
    this.sweeps += 1;
    this.total += 1;
  }

  /** The status of the last second. */
  take(name: string): RobotStatus {
    const status: RobotStatus = {
      name,
      connected: true,
      bytes_per_second: this.bytes,
      bytes_per_sweep: this.sweeps > 0 ? this.bytes / this.sweeps : null,
      level: null,
      queue_frames: null,
      queue_bytes: null,
      age_ms: null,
      drops: null,
      sender_drops: null,
      qoe: null,
      sweeps: this.total,
      can_override: false,
      override: null,
    };
    this.bytes = 0;
    this.sweeps = 0;
    return status;
  }
}
