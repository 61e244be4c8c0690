// The real programs, started and ended.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { createServer } from 'node:net';
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

/** A running `sweepcast`; ended by `stop`, which asserts nothing. */
export class Program {
  constructor(...args) {
    this.child = spawn(kTool, args.map(String), { stdio: ['ignore', 'pipe', 'pipe'] });
    this.said = '';
    for (const stream of [this.child.stdout, this.child.stderr]) stream.on('data', (data) => (this.said += data));
    this.ended = once(this.child, 'exit');
  }

  async stop() {
    if (this.child.exitCode === null) this.child.kill('SIGTERM');
    await this.ended;
  }
}

/** Waits until the server at `port` is ready. */
export async function waitUntilReady(program, port) {
  for (;;) {
    if (program.child.exitCode !== null) throw new Error(`it ended: ${program.said}`);
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
