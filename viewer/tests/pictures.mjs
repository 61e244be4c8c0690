// Pictures compared with those in the repository.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PNG } from 'pngjs';

const kCell = 16; // pixels: cells are compared, since single points may fall a pixel aside
const kMostMean = 12; // of 255, between the mean colours of a cell
const kMostCells = 0.02; // share of cells that may differ by more

/** The mean red, green and blue of each cell. */
function cellsOf(png) {
  const cells = [];
  for (let y = 0; y + kCell <= png.height; y += kCell) {
    for (let x = 0; x + kCell <= png.width; x += kCell) {
      const sum = [0, 0, 0];
      for (let dy = 0; dy < kCell; ++dy) {
        for (let dx = 0; dx < kCell; ++dx) {
          const at = ((y + dy) * png.width + x + dx) * 4;
          for (let channel = 0; channel < 3; ++channel) sum[channel] += png.data[at + channel];
        }
      }
      cells.push(sum.map((value) => value / kCell ** 2));
    }
  }
  return cells;
}

/** Asserts that `bytes` shows what the picture at `url` shows; with UPDATE_PICTURES=1 it becomes it. */
export async function comparePictures(bytes, url) {
  const file = fileURLToPath(url);
  if (process.env.UPDATE_PICTURES) {
    mkdirSync(dirname(file), { recursive: true });
    writeFileSync(file, bytes);
    return;
  }
  assert.ok(existsSync(file), `${file} is missing; UPDATE_PICTURES=1 npm test makes it`);
  const [got, wanted] = [PNG.sync.read(bytes), PNG.sync.read(readFileSync(file))];
  assert.deepEqual([got.width, got.height], [wanted.width, wanted.height]);
  const [a, b] = [cellsOf(got), cellsOf(wanted)];
  const lit = b.filter((cell) => Math.max(...cell) > 40).length;
  assert.ok(lit > b.length / 20, 'the picture in the repository shows something');
  const off = a.filter((cell, i) => cell.some((value, channel) => Math.abs(value - b[i][channel]) > kMostMean)).length;
  if (off > kMostCells * a.length) {
    const out = fileURLToPath(new URL('../out', import.meta.url));
    mkdirSync(out, { recursive: true });
    writeFileSync(join(out, 'view.png'), bytes);
    assert.fail(`${off} of ${a.length} cells differ from ${file}; what was drawn is in ${out}`);
  }
}
