// A server that speaks what docs/view.md says and misbehaves when told to: damages frames, goes
// silent, goes away. For what the real one does not do at will.
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { WebSocketServer } from 'ws';

const kPage = fileURLToPath(new URL('../dist', import.meta.url));
const kTypes = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml', '.wasm': 'application/wasm' };
// As src/view/routes.cpp has it.
const kPolicy =
  "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; img-src 'self' data: blob:; " +
  "base-uri 'none'; form-action 'none'; frame-ancestors 'none'; object-src 'none'";

function sweepMessage(index, { name, frame }, hasOriginal, ageMs) {
  const label = Buffer.from(name);
  const head = Buffer.alloc(20);
  head.write('SWV1', 0, 'latin1');
  head.writeUInt8(0, 4);
  head.writeUInt8(hasOriginal ? 1 : 0, 5);
  head.writeUInt16LE(label.length, 6);
  head.writeUInt32LE(index, 8);
  head.writeUInt32LE(ageMs, 12);
  head.writeUInt16LE(4, 16);
  head.writeUInt16LE(4, 18);
  return Buffer.concat([head, label, frame]);
}

export class MockServer {
  /** `sweeps`: { name, frame }; `original(i)`: the bytes of an original, or null. */
  constructor(sweeps, { live = false, original = null, rate = 10, obeys = true, reports = true } = {}) {
    // `obeys`: the robot sends at the level that it is asked for; `reports`: its sender tells of itself.
    Object.assign(this, { sweeps, live, original, rate, obeys, reports });
    this.level = null; // asked for
    this.damaged = new Set(); // indices whose frame is sent with a byte changed
    this.silent = false;
    this.received = []; // every message of every client
    this.clients = new Set();
  }

  async start(port = 0) {
    this.http = createServer((request, response) => this.answer(request, response));
    this.sockets = new WebSocketServer({ server: this.http, path: '/live', handleProtocols: () => 'sweepcast.view.v1' });
    this.sockets.on('connection', (socket) => this.greet(socket));
    await new Promise((resolve) => this.http.listen(port, '127.0.0.1', resolve));
    this.port = this.http.address().port;
    this.timers = [setInterval(() => this.tick(), 1000 / this.rate), setInterval(() => this.status(), 1000)];
    this.startedAt = Date.now();
  }

  async stop() {
    for (const timer of this.timers) clearInterval(timer);
    for (const client of this.clients) client.socket.terminate();
    this.sockets.close();
    this.http.closeAllConnections();
    await new Promise((resolve) => this.http.close(resolve));
  }

  /** Sends `message` to everybody. */
  say(message) {
    for (const { socket } of this.clients) socket.send(JSON.stringify(message));
  }

  answer(request, response) {
    const path = new URL(request.url, 'http://localhost').pathname;
    const wanted = path.match(/^\/original\/(\d+)$/);
    if (wanted) {
      const bytes = this.original?.(Number(wanted[1]));
      response.writeHead(bytes ? 200 : 404, { 'X-Fields': 'x y z intensity' }).end(bytes ?? '');
      return;
    }
    const file = join(kPage, normalize(path === '/' ? '/index.html' : path));
    if (!file.startsWith(kPage) || !existsSync(file)) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'Content-Type': kTypes[extname(file)] ?? 'application/octet-stream', 'Content-Security-Policy': kPolicy });
    createReadStream(file).pipe(response);
  }

  greet(socket) {
    const client = { socket, credit: 0, index: 0, playing: true, speed: 1, loop: true, due: true };
    this.clients.add(client);
    socket.on('close', () => this.clients.delete(client));
    socket.on('message', (data) => this.hear(client, JSON.parse(data)));
    const sensor = { id: 0, robot: this.live ? 'rover' : 'drive', sensor: 'lidar' };
    socket.send(
      JSON.stringify({
        kind: 'hello', version: 1, source: this.live ? 'live' : 'file', title: this.live ? 'rover' : 'drive.sweep', rate_hz: this.rate,
        frames: this.live ? null : this.sweeps.length, has_original: this.original !== null, streams: [sensor],
      }),
    );
    this.tellState(client);
  }

  hear(client, message) {
    this.received.push(message);
    if (message.kind === 'more') client.credit += message.count;
    if (message.kind === 'speed') client.speed = message.value;
    if (message.kind === 'loop') client.loop = message.value;
    if (message.kind === 'play') client.playing = true;
    if (message.kind === 'pause') client.playing = false;
    if (message.kind === 'seek') [client.index, client.due] = [Math.min(Math.max(message.index, 0), this.sweeps.length - 1), true];
    if (message.kind === 'override' && this.obeys) this.level = message.level;
    if (message.kind !== 'more') this.tellState(client);
    this.send(client);
  }

  tellState(client) {
    if (this.live) return;
    client.socket.send(JSON.stringify({ kind: 'state', index: client.index, playing: client.playing, speed: client.speed, loop: client.loop }));
  }

  tick() {
    for (const client of this.clients) {
      if (client.playing && !client.due) [client.index, client.due] = [(client.index + 1) % this.sweeps.length, true];
      this.send(client);
    }
  }

  send(client) {
    if (!client.due || client.credit === 0 || this.silent) return;
    client.due = false;
    client.credit -= 1;
    const sweep = { ...this.sweeps[client.index] };
    if (this.damaged.has(client.index)) {
      sweep.frame = Buffer.from(sweep.frame);
      sweep.frame[sweep.frame.length >> 1] ^= 0x55;
    }
    client.socket.send(sweepMessage(client.index, sweep, this.original !== null, this.live ? 87 : 0));
  }

  status() {
    if (!this.live) return;
    const time = (Date.now() - this.startedAt) / 1000;
    const wave = Math.sin(time / 3);
    const robot = {
      name: 'rover', connected: true, bytes_per_second: 150e3 + 40e3 * wave, bytes_per_sweep: 15e3 + 4e3 * wave,
      age_ms: 90 + 30 * wave, drops: Math.floor(time / 20), sweeps: Math.floor(time * 10), can_override: this.obeys && this.reports,
      ...(this.reports
        ? {
            level: this.level ?? (wave > 0 ? 1 : 2), queue_frames: wave > 0.5 ? 2 : 0, queue_bytes: wave > 0.5 ? 21e3 : 0,
            sender_drops: Math.floor(time / 30), qoe: 13.5 + wave, override: this.level,
          }
        : { level: null, queue_frames: null, queue_bytes: null, sender_drops: null, qoe: null, override: null }),
    };
    this.say({ kind: 'status', time_s: time, robots: [robot] });
  }
}

// `npm run mock FILE.sweep [live]`: the page, played from a file, at port 8090.
if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { readFileSync } = await import('node:fs');
  const { readSweepFile } = await import('./sweep_file.mjs');
  const server = new MockServer(readSweepFile(readFileSync(process.argv[2])), { live: process.argv[3] === 'live' });
  await server.start(8090);
  console.log(`http://127.0.0.1:${server.port}/`);
}
