// The decoder in WebAssembly gives what the tool gives, bit for bit.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from './limited.mjs';
import { fileURLToPath } from 'node:url';
import { loadDecoder, loadModule } from './load.mjs';
import { kTool, makeDrive } from './made_sweeps.mjs';
import { readSweepFile } from './sweep_file.mjs';

const kGolden = fileURLToPath(new URL('../../tests/golden', import.meta.url));
const kAll = { fill: false, layers: 64 };

let decoder;
let work;
before(async () => {
  decoder = await loadDecoder();
  work = mkdtempSync(join(tmpdir(), 'sweepcast-wasm-'));
});
after(() => rmSync(work, { recursive: true, force: true }));

// zlib's checksum, by its definition.
function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (0xedb88320 & -(crc & 1));
  }
  return ~crc >>> 0;
}

/** The bytes of numbers, NaN always the same: tests/golden/frames.hpp. */
function sameNan(values) {
  const bits = new Uint32Array(values.length);
  new Float32Array(bits.buffer).set(values);
  return Buffer.from(bits.map((word, i) => (Number.isNaN(values[i]) ? 0x7fc00000 : word)).buffer);
}

/** The bytes of a cloud as `decode --format bin` writes them: x, y, z, intensity (0 without one). */
function binOf(cloud) {
  const values = new Float32Array(cloud.points * 4);
  for (let i = 0; i < cloud.points; ++i) {
    values.set(cloud.xyz.subarray(3 * i, 3 * i + 3), 4 * i);
    values[4 * i + 3] = cloud.intensity?.[i] ?? 0;
  }
  return Buffer.from(values.buffer);
}

for (const file of readdirSync(kGolden).filter((name) => name.endsWith('.frame'))) {
  test(`golden frame ${file}`, () => {
    const wanted = Object.fromEntries(
      readFileSync(join(kGolden, file.replace('.frame', '.txt')), 'utf8').trim().split('\n').map((line) => line.split(' ')),
    );
    const cloud = decoder.decode(readFileSync(join(kGolden, file)), kAll);
    assert.equal(cloud.points, Number(wanted.points));
    assert.equal(crc32(sameNan(cloud.xyz)), Number(wanted.xyz_crc32));
    if (wanted.attributes_crc32 === undefined) return; // the first frames had none
    const columns = [
      cloud.intensity ?? [],
      cloud.ring ?? [],
      BigInt64Array.from(cloud.timeNs ?? [], BigInt),
      Uint32Array.of(cloud.width),
    ].map((column) => Buffer.from(column.buffer ?? []));
    assert.equal(crc32(Buffer.concat(columns)), Number(wanted.attributes_crc32));
  });
}

function compareWithTool(sweepFile, fill) {
  const out = mkdtempSync(join(work, 'decoded-'));
  execFileSync(kTool, ['decode', sweepFile, '-o', out, ...(fill ? ['--fill'] : [])], { stdio: 'pipe' });
  const written = readdirSync(out).sort();
  const records = readSweepFile(readFileSync(sweepFile));
  assert.equal(written.length, records.length);
  let filled = 0;
  records.forEach(({ frame }, i) => {
    const cloud = decoder.decode(frame, { fill, layers: 64 });
    filled += cloud.filled ? cloud.filled.reduce((sum, one) => sum + one, 0) : 0;
    assert.deepEqual(binOf(cloud), readFileSync(join(out, written[i])));
  });
  return filled;
}

for (const options of [[], ['--level', '3'], ['--codec', 'rcpcc', '--level', '1'], ['--effort', 'best']]) {
  test(`a drive encoded with ${options.join(' ') || 'no options'}, against the tool`, () => {
    const drive = makeDrive(3, ...options);
    try {
      compareWithTool(drive.file, false);
      if (options[1] === '3') assert.ok(compareWithTool(drive.file, true) > 0, 'level 3 leaves something to fill in');
    } finally {
      drive.done();
    }
  });
}

test('a real sweep of KITTI, against the tool', (t) => {
  if (!process.env.SWEEPCAST_DATA) return t.skip('SWEEPCAST_DATA is not set');
  const file = join(work, 'kitti.sweep');
  execFileSync(kTool, ['encode', join(process.env.SWEEPCAST_DATA, 'kitti_hdl64'), '-o', file, '--max-error', '0.05'], { stdio: 'pipe' });
  compareWithTool(file, false);
});

test('damaged frames are refused, and the next one decodes', () => {
  const sound = readFileSync(join(kGolden, 'beam_normal.frame'));
  const points = decoder.decode(sound, kAll).points;
  for (let at = 0; at < sound.length; at += 37) {
    const frame = Buffer.from(sound);
    frame[at] ^= 0x10;
    assert.throws(() => decoder.decode(frame, kAll), (error) => error.message.length > 5, `byte ${at}`);
  }
  assert.throws(() => decoder.decode(sound.subarray(0, 60), kAll));
  assert.throws(() => decoder.decode(new Uint8Array(0), kAll));
  assert.equal(decoder.decode(sound, kAll).points, points);
});

test('errors against the original are distances to the nearest point', async () => {
  const { errorsAgainst, kLargestError } = await loadModule('nearest');
  let seed = 7;
  const random = () => (seed = (Math.imul(seed, 1103515245) + 12345) >>> 0) / 2 ** 32;
  const cloud = (points, size) => Float32Array.from({ length: points * 3 }, () => (random() - 0.5) * size);
  const [decoded, original] = [cloud(400, 8), cloud(700, 7)];
  const errors = errorsAgainst(decoded, original);
  for (let i = 0; i < 400; ++i) {
    let least = Infinity;
    for (let j = 0; j < 700; ++j) {
      least = Math.min(least, Math.hypot(...[0, 1, 2].map((axis) => decoded[3 * i + axis] - original[3 * j + axis])));
    }
    assert.ok(Math.abs(errors[i] - Math.min(least, kLargestError)) < 1e-5, `${errors[i]} is not ${least}`);
  }
});
