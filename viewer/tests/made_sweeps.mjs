// A made-up drive: a 32-beam sensor in a street of houses and posts, and a van that comes nearer.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { readSweepFile } from './sweep_file.mjs';

export const kTool = process.env.SWEEPCAST ?? fileURLToPath(new URL('../../build/release/sweepcast', import.meta.url));

const kBeams = 32;
const kFirings = 1080;
const kSensorHeight = 1.73;

/** Boxes of the street: [x0, x1, y0, y1, z0, z1, reflectivity]. */
function boxesOf(sweep) {
  const boxes = [
    [-40, 18, 9, 20, -kSensorHeight, 7, 0.35],
    [24, 60, 11, 20, -kSensorHeight, 10, 0.5],
    [-40, 60, -22, -12, -kSensorHeight, 6, 0.25],
    [14 - sweep * 0.8, 19 - sweep * 0.8, -4.4, -2.4, -kSensorHeight + 0.2, 0.6, 0.8],
    [6, 10.2, 5.2, 7, -kSensorHeight + 0.2, -0.2, 0.6],
  ];
  for (let x = -30; x < 45; x += 9) boxes.push([x, x + 0.25, 7.4, 7.65, -kSensorHeight, 3.5, 0.9]);
  return boxes;
}

/** Where the ray from the origin hits a box first; Infinity where it misses. */
function hit([dx, dy, dz], [x0, x1, y0, y1, z0, z1]) {
  let [near, far] = [0, Infinity];
  for (const [d, low, high] of [[dx, x0, x1], [dy, y0, y1], [dz, z0, z1]]) {
    const [a, b] = [low / d, high / d];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return near <= far && near > 0 ? near : Infinity;
}

/** Points of one sweep: x, y, z, intensity as float32. */
export function makeSweep(sweep) {
  const boxes = boxesOf(sweep);
  const values = [];
  let seed = 12345 + sweep;
  const noise = () => ((seed = (Math.imul(seed, 1103515245) + 12345) >>> 0) / 2 ** 32 - 0.5) * 0.02;
  for (let beam = 0; beam < kBeams; ++beam) {
    const elevation = ((4 - (30 * beam) / (kBeams - 1)) * Math.PI) / 180;
    for (let firing = 0; firing < kFirings; ++firing) {
      const azimuth = (-2 * Math.PI * firing) / kFirings;
      const way = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
      let range = way[2] < 0 ? -kSensorHeight / way[2] : Infinity;
      let brightness = 0.15;
      for (const box of boxes) {
        const at = hit(way, box);
        if (at < range) [range, brightness] = [at, box[6]];
      }
      if (range > 90) continue;
      range += noise();
      values.push(...way.map((part) => part * range), Math.round(brightness * 255) / 255);
    }
  }
  return new Float32Array(values);
}

/**
 * A folder with `drive.sweep` of so many sweeps and the originals in `sweeps/`; the caller removes it
 * by `done()`. `options`: more for `sweepcast encode`.
 */
export function makeDrive(count, ...options) {
  if (!existsSync(kTool)) throw new Error(`${kTool} is missing; build it first, or set SWEEPCAST to where it is`);
  const folder = mkdtempSync(join(tmpdir(), 'sweepcast-viewer-'));
  const sweeps = join(folder, 'sweeps');
  const file = join(folder, 'drive.sweep');
  mkdirSync(sweeps);
  for (let i = 0; i < count; ++i) {
    writeFileSync(join(sweeps, `${String(i).padStart(6, '0')}.bin`), Buffer.from(makeSweep(i).buffer));
  }
  execFileSync(kTool, ['encode', sweeps, '-o', file, ...options], { stdio: 'pipe' });
  return {
    folder,
    sweeps,
    file,
    original: (i) => readFileSync(join(sweeps, `${String(i).padStart(6, '0')}.bin`)),
    done: () => rmSync(folder, { recursive: true, force: true }),
  };
}

/** The drive's sweeps as a server sends them: each decodes alone, so each has its sensor's model. */
export function framesOf(drive, ...options) {
  return readdirSync(drive.sweeps).sort().map((name) => {
    const file = join(drive.folder, 'one.sweep');
    execFileSync(kTool, ['encode', join(drive.sweeps, name), '-o', file, ...options], { stdio: 'pipe' });
    return readSweepFile(readFileSync(file))[0];
  });
}
