// npm run speed FILE.sweep: what WebAssembly costs. Each frame's decoding by the page's decoder and by
// the tool, least of five passes.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { loadDecoder } from './load.mjs';
import { kTool } from './made_sweeps.mjs';
import { readSweepFile } from './sweep_file.mjs';

const kPasses = 5;
const [file] = process.argv.slice(2);
if (!file) {
  console.error('npm run speed FILE.sweep: name a recording, as `sweepcast encode` makes it');
  process.exit(2);
}

const least = (rows) => rows[0].map((_, frame) => Math.min(...rows.map((row) => row[frame])));
const mean = (numbers) => numbers.reduce((sum, number) => sum + number, 0) / numbers.length;
const passes = (run) => Array.from({ length: kPasses }, run);

function byTool() {
  const folder = mkdtempSync(join(tmpdir(), 'sweepcast-speed-'));
  try {
    const report = execFileSync(kTool, ['decode', file, '-o', folder, '--json'], { maxBuffer: 1 << 28 });
    return JSON.parse(report).frames.map((frame) => frame.decode_ms);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

async function byPage() {
  const decoder = await loadDecoder(); // anew, since frames may need those before them
  return readSweepFile(readFileSync(file)).map(({ frame }) => {
    const before = process.cpuUsage();
    decoder.decode(frame, { fill: false, layers: 64 });
    const spent = process.cpuUsage(before);
    return (spent.user + spent.system) / 1000;
  });
}

const native = mean(least(passes(byTool)));
const wasm = [];
for (let pass = 0; pass < kPasses; ++pass) wasm.push(await byPage());
const page = mean(least(wasm));
console.log(`${native.toFixed(1)} ms native, ${page.toFixed(1)} ms WebAssembly a sweep: ${(page / native).toFixed(2)} times`);
