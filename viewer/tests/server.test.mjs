// The page as the program serves it: files, tokens, and a live stream through the link's emulator.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from './limited.mjs';
import { launch, open, waitForSweep } from './browser.mjs';
import { kTool, makeDrive } from './made_sweeps.mjs';
import { freePort, startLive, startView } from './programs.mjs';
import { readSweepFile } from './sweep_file.mjs';

const kSweeps = 12;
const kPage = new URL('../dist/index.html', import.meta.url);

let browser;
let drive;
before(async () => {
  drive = makeDrive(kSweeps, '--level', '3');
  browser = await launch();
});
after(async () => {
  await browser?.close();
  drive?.done();
});

const text = (page, id) => page.textContent(`#${id}`);
const placeIs = (page, place) => page.waitForFunction((wanted) => document.getElementById('place').textContent === wanted, place);
const said = (page, pattern) => page.waitForFunction((source) => new RegExp(source).test(document.getElementById('banner').textContent), pattern.source);
const quiet = (page) => page.waitForFunction(() => document.getElementById('banner').textContent === '');

test('the program has the page that was built', async () => {
  const view = await startView(await freePort(), drive.file);
  try {
    const served = await (await fetch(view.url)).text();
    assert.ok(served === readFileSync(kPage, 'utf8'), `${kTool} has another page than viewer/dist; build it again: cmake --build --preset release`);
  } finally {
    await view.stop();
  }
});

test('a file plays, scrubs, is compared with its original, and survives a restart', async () => {
  const port = await freePort();
  let view = await startView(port, drive.file, '--original', drive.sweeps);
  const { page, complaints, close } = await open(browser, view.url, { ignore: /ERR_CONNECTION_REFUSED|WebSocket connection/ });
  try {
    await waitForSweep(page);
    assert.equal(await text(page, 'title'), 'drive.sweep');
    const first = await text(page, 'place');
    await page.waitForFunction((was) => document.getElementById('place').textContent !== was, first);
    await page.click('#play');
    await page.fill('#scrub', '7');
    await placeIs(page, `8 / ${kSweeps}`);
    await page.selectOption('#mode', 'error');
    await page.waitForFunction(() => /nearest original/.test(document.getElementById('legend-text').textContent));
    const high = parseFloat(await text(page, 'legend-high'));
    assert.ok(high > 0.1 && high < 60, `${high} cm`);
    await page.focus('#view');
    await page.keyboard.press('f');
    await page.waitForFunction(() => /\+ [\d,]+ filled/.test(document.getElementById('fact-points').textContent));

    await view.stop();
    await said(page, /No connection to the server/);
    view = await startView(port, drive.file, '--original', drive.sweeps);
    await quiet(page);
    await placeIs(page, `8 / ${kSweeps}`);
    await page.keyboard.press('ArrowRight');
    await placeIs(page, `9 / ${kSweeps}`);
    assert.deepEqual(complaints, []);
  } finally {
    await close();
    await view.stop();
  }
});

test('a damaged frame of a file is named, and the others are shown', async () => {
  const bytes = readFileSync(drive.file);
  const frame = readSweepFile(bytes)[4].frame; // a part of `bytes`
  frame[frame.length >> 1] ^= 0x55;
  const file = join(drive.folder, 'damaged.sweep');
  writeFileSync(file, bytes);
  const view = await startView(await freePort(), file);
  const { page, complaints, close } = await open(browser, view.url);
  try {
    await said(page, /damaged\.sweep: frame 4: .* is damaged/);
    await placeIs(page, `7 / ${kSweeps}`);
    assert.deepEqual(complaints, []);
  } finally {
    await close();
    await view.stop();
  }
});

test('with a token only who has it sees anything', async () => {
  const view = await startView(await freePort(), drive.file, '--token', 'let-me-in');
  const { page, complaints, close } = await open(browser, `${view.url}?token=let-me-in`);
  try {
    assert.equal((await fetch(view.url)).status, 401);
    assert.equal((await fetch(`${view.url}original/0?stream=0`)).status, 401);
    await waitForSweep(page);
    assert.deepEqual(complaints, []);
  } finally {
    await close();
    await view.stop();
  }
});

test('a live stream through the emulator: shown, counted, missed when it stops, shown again, also by a server that was started again', async () => {
  const live = await startLive(drive.folder);
  const { page, complaints, close } = await open(browser, live.url, { ignore: /ERR_CONNECTION_REFUSED|WebSocket connection/ });
  try {
    let sender = live.send(drive.sweeps);
    await waitForSweep(page);
    assert.equal(await text(page, 'badge'), 'live');
    await page.keyboard.press('d');
    await page.waitForFunction(() => /rover.*B\/s.*sweeps/.test(document.getElementById('robots').textContent));
    await sender.stop();
    await said(page, /stopped|No sweep has arrived/);
    const before = await text(page, 'robots');
    sender = live.send(drive.sweeps);
    await page.waitForFunction((was) => document.getElementById('robots').textContent !== was, before);
    await page.waitForFunction(() => !/No sweep has arrived/.test(document.getElementById('banner').textContent));

    await live.stopServer();
    await said(page, /No connection to the server/);
    await live.startServer();
    await page.waitForFunction(() => !/No connection/.test(document.getElementById('banner').textContent));
    await waitForSweep(page);
    const shown = await text(page, 'robots');
    await page.waitForFunction((was) => document.getElementById('robots').textContent !== was, shown);
    assert.deepEqual(complaints, []);
  } catch (error) {
    error.message += live.said();
    throw error;
  } finally {
    await close();
    await live.stop();
  }
});
