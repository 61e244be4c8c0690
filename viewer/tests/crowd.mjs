// What a crowd costs: `npm run crowd -- [SECONDS [INPUT]]`. A robot sends live to `sweepcast receive
// --view`; ten clients look on as the page does, one of them takes nothing from its socket. Fails where
// one of the others lacks sweeps that arrived, where fewer than 10 a second do, or where the server's
// memory grows after the first minute (the first fifth of a shorter run).
import { execFileSync } from 'node:child_process';
import { once } from 'node:events';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { WebSocket } from 'ws';
import { kTool, makeDrive } from './made_sweeps.mjs';
import { freePort, Program, waitUntilReady } from './programs.mjs';

const kClients = 10;
const kSentHz = 10.5; // a sender that is late does not catch up, so a little more than
const kLeastHz = 10;
const kLeastShare = 0.99; // of the sweeps that arrived
const kMostGrowthKib = 2048;
const kAhead = 2; // as the page
const kMostAhead = 64; // the server's limit

/** Of the server, by Linux: memory in KiB, CPU seconds. */
function usageOf(pid) {
  const memory = Number(readFileSync(`/proc/${pid}/status`, 'utf8').match(/VmRSS:\s+(\d+)/)[1]);
  const times = readFileSync(`/proc/${pid}/stat`, 'utf8').split(') ')[1].split(' ');
  return { memory, cpu: (Number(times[11]) + Number(times[12])) / 100 };
}

/** A client that grants room and counts; a stalled one asks for all it may have, and reads nothing. */
class Client {
  constructor(port, stalled) {
    Object.assign(this, { port, stalled, sweeps: 0, arrived: 0, bytes: 0, closed: 0, leaving: false });
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(`ws://127.0.0.1:${this.port}/live`, 'sweepcast.view.v1');
    this.socket.on('error', () => undefined);
    this.socket.on('open', () => {
      if (this.stalled) this.stall();
      else this.grant(kAhead);
    });
    this.socket.on('message', (data, isBinary) => {
      if (!isBinary) return this.hear(JSON.parse(data));
      this.sweeps += 1;
      this.bytes += data.length;
      this.grant(1);
    });
    this.socket.on('close', () => {
      this.closed += 1;
      if (!this.leaving) setTimeout(() => this.connect(), 100);
    });
  }

  stall() {
    this.socket.pause();
    const timer = setInterval(() => this.grant(kMostAhead), 1000);
    this.socket.on('close', () => clearInterval(timer));
  }

  hear(message) {
    if (message.kind === 'status') this.arrived = message.robots[0]?.sweeps ?? 0;
  }

  grant(count) {
    this.socket.send(JSON.stringify({ kind: 'more', count }));
  }

  leave() {
    this.leaving = true;
    this.socket.terminate();
  }
}

async function watch(seconds, clients, pid) {
  const samples = [];
  const begin = performance.now();
  for (let second = 0; second <= seconds; ++second) {
    const wait = begin + second * 1000 - performance.now();
    await new Promise((resolve) => setTimeout(resolve, Math.max(wait, 0)));
    samples.push({ at: (performance.now() - begin) / 1000, ...usageOf(pid), sweeps: clients.map(({ sweeps }) => sweeps), arrived: Math.max(...clients.map(({ arrived }) => arrived)) });
    if (process.stderr.isTTY) process.stderr.write(`\r${second} s, ${samples.at(-1).memory} KiB `);
  }
  if (process.stderr.isTTY) process.stderr.write('\r\x1b[K');
  return samples;
}

const rate = (from, to, client) => (to.sweeps[client] - from.sweeps[client]) / (to.at - from.at);

function judge(samples, clients) {
  const [first, last] = [samples[0], samples.at(-1)];
  const settled = Math.min(60, Math.floor(samples.length / 5));
  const looking = clients.flatMap(({ stalled }, i) => (stalled ? [] : [i]));
  const rates = looking.map((i) => rate(first, last, i));
  const windows = samples.slice(10).flatMap((to, k) => looking.map((i) => rate(samples[k], to, i)));
  const arrived = (last.arrived - first.arrived) / (last.at - first.at);
  const peak = (some) => Math.max(...some.map(({ memory }) => memory));
  const [early, late] = [peak(samples.slice(0, settled + 1)), peak(samples.slice(settled))];
  console.log(`${arrived.toFixed(2)} sweeps a second arrived`);
  console.log(`${looking.length} clients: ${Math.min(...rates).toFixed(2)} to ${Math.max(...rates).toFixed(2)} sweeps a second; the least in 10 s: ${Math.min(...windows).toFixed(1)}`);
  console.log(`a client that reads nothing: closed ${clients.find(({ stalled }) => stalled).closed} times, and back each time`);
  console.log(`memory: ${first.memory} KiB at first, at most ${early} KiB in the first ${settled} s and ${late} KiB after them`);
  console.log(`the server's CPU time: ${(((last.cpu - first.cpu) / (last.at - first.at)) * 100).toFixed(1)} % of a core, for ${clients.reduce((sum, { bytes }) => sum + bytes, 0) / 1e6 | 0} MB`);
  const faults = [];
  if (arrived < kLeastHz) faults.push(`fewer than ${kLeastHz} sweeps a second arrived; run it where less else runs`);
  if (Math.min(...rates) < kLeastShare * arrived) faults.push('a client lacks sweeps that arrived');
  if (late > early + kMostGrowthKib) faults.push('memory grew');
  return faults;
}

const [seconds = '300', input] = process.argv.slice(2);
const drive = makeDrive(60);
const programs = [];
const start = (...args) => programs[programs.push(new Program(...args)) - 1];
const clients = [];
try {
  const key = join(drive.folder, 'rover.key');
  execFileSync(kTool, ['keygen', key, '--robot', 'rover'], { stdio: 'pipe' });
  const [port, viewPort] = [await freePort(), await freePort()];
  const receive = start('receive', '--listen', port, '--keys', key, '-o', join(drive.folder, 'got.sweep'), '--view', viewPort);
  await waitUntilReady(receive, viewPort);
  start('send', input ?? drive.file, '--to', `127.0.0.1:${port}`, '--key', key, '--loop', '--rate', kSentHz);
  for (let i = 0; i < kClients; ++i) clients.push(new Client(viewPort, i === 0));
  await once(clients.at(-1).socket, 'message');
  while (clients.some(({ stalled, sweeps }) => !stalled && sweeps === 0)) await new Promise((resolve) => setTimeout(resolve, 50));
  const faults = judge(await watch(Number(seconds), clients, receive.child.pid), clients);
  for (const fault of faults) console.error(`FAILED: ${fault}`);
  process.exitCode = faults.length > 0 ? 1 : 0;
} finally {
  for (const client of clients) client.leave();
  for (const program of programs) await program.stop();
  drive.done();
}
