// The real programs, started and ended.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { kTool } from './made_sweeps.mjs';

/** A port that nobody has at the moment. */
export async function freePort() {
  const server = createServer().listen(0, '127.0.0.1');
  await once(server, 'listening');
  const { port } = server.address();
  server.close();
  await once(server, 'close');
  return port;
}

const kPatienceMs = 30_000;

const running = new Set();
process.on('exit', () => running.forEach((child) => child.kill('SIGKILL')));

/** A running `sweepcast`; ended by `stop`, which asserts nothing, or with this process. */
export class Program {
  constructor(...args) {
    this.child = spawn(kTool, args.map(String), { stdio: ['ignore', 'pipe', 'pipe'] });
    this.said = '';
    for (const stream of [this.child.stdout, this.child.stderr]) stream.on('data', (data) => (this.said += data));
    this.ended = once(this.child, 'exit').finally(() => running.delete(this.child));
    running.add(this.child);
  }

  async stop() {
    if (this.child.exitCode === null) this.child.kill('SIGTERM');
    const killer = setTimeout(() => this.child.kill('SIGKILL'), kPatienceMs);
    await this.ended;
    clearTimeout(killer);
  }
}

/** Waits until the server at `port` is ready. */
export async function waitUntilReady(program, port) {
  for (const until = performance.now() + kPatienceMs; ; ) {
    if (program.child.exitCode !== null) throw new Error(`it ended: ${program.said}`);
    if (performance.now() > until) throw new Error(`it does not answer at port ${port}: ${program.said}`);
    const answer = await fetch(`http://127.0.0.1:${port}/healthz`).catch(() => null);
    if (answer?.status === 200) return;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/** `sweepcast view` with these arguments, ready; `url` is its page. */
export async function startView(port, ...args) {
  const program = new Program('view', ...args, '--port', port);
  await waitUntilReady(program, port);
  return Object.assign(program, { url: `http://127.0.0.1:${port}/` });
}

/**
 * A robot's sweeps, live: `receive --view`, a link of the paper's bandwidths if `relay`, and no sender yet:
 * `send(INPUT)` starts one. `folder` takes the key and what is received. `url` is the page.
 */
export async function startLive(folder, { relay = true } = {}) {
  const key = join(folder, 'rover.key');
  execFileSync(kTool, ['keygen', key, '--robot', 'rover'], { stdio: 'pipe' });
  const [viewPort, port, relayPort] = [await freePort(), await freePort(), await freePort()];
  const programs = [];
  const start = (...args) => programs[programs.push(new Program(...args)) - 1];
  const view = ['--listen', port, '--keys', key, '-o', join(folder, 'received'), '--view', viewPort];
  let receive;
  const startServer = async () => {
    receive = start('receive', ...view);
    await waitUntilReady(receive, viewPort);
  };
  if (relay) start('emulate-link', '--listen', relayPort, '--to', port, '--trace', 'paper', '--delay', 20);
  await startServer();
  return {
    url: `http://127.0.0.1:${viewPort}/`,
    startServer,
    stopServer: () => receive.stop(),
    send: (input, ...more) => start('send', input, '--to', `127.0.0.1:${relay ? relayPort : port}`, '--key', key, '--loop', ...more),
    said: () => programs.map(({ child, said }) => `\n${child.spawnargs[1]}: ${said.slice(-500)}`).join(''),
    stop: async () => {
      for (const program of programs) await program.stop();
    },
  };
}
