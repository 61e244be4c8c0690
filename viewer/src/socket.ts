// The connection to the server: opens itself again after it was lost, and says how many sweeps the
// page still has room for.
import { readSweep, readText, type ClientMessage, type ServerMessage, type SweepMessage } from './wire';

const kProtocol = 'sweepcast.view.v1';
const kAhead = 2; // sweeps on their way while one is decoded and drawn
const kFirstWaitMs = 500;
const kLongestWaitMs = 5000;

export interface ConnectionEvents {
  onOpen(): void;
  /** The connection is gone; the next attempt follows in so many milliseconds. */
  onLost(waitMs: number): void;
  onMessage(message: ServerMessage): void;
  onSweep(sweep: SweepMessage): void;
}

/** The address of `path` beside the page, with the page's token. */
export function serverUrl(path: string): URL {
  const url = new URL(path, location.href);
  url.hash = '';
  const token = new URLSearchParams(location.search).get('token');
  if (token !== null) url.searchParams.set('token', token);
  return url;
}

export class Connection {
  private socket: WebSocket | null = null;
  private wait = kFirstWaitMs;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly events: ConnectionEvents) {}

  open(): void {
    clearTimeout(this.timer);
    const url = serverUrl('live');
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = new WebSocket(url, kProtocol);
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    socket.onopen = () => {
      this.wait = kFirstWaitMs;
      this.events.onOpen();
      this.send({ kind: 'more', count: kAhead });
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => this.receive(event.data);
    socket.onclose = () => this.retry(socket);
  }

  /** Says that one more sweep may come. */
  grant(): void {
    this.send({ kind: 'more', count: 1 });
  }

  send(message: ClientMessage): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data === 'string') {
      const message = readText(data);
      if (message) this.events.onMessage(message);
      return;
    }
    const sweep = readSweep(data);
    if (sweep) {
      this.events.onSweep(sweep);
    } else {
      this.grant(); // it counted as a sweep, whatever it was
    }
  }

  private retry(socket: WebSocket): void {
    if (socket !== this.socket) return;
    this.socket = null;
    this.events.onLost(this.wait);
    this.timer = setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(this.wait * 1.6, kLongestWaitMs);
  }
}
