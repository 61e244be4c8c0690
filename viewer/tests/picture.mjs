// Pictures of the page, live over a link of the paper's bandwidths: `npm run picture -- [SWEEPS [OUT.png]]`,
// SWEEPS as `sweepcast send` takes them. The README's is made of the drive that ./quickstart simulates.
// `npm run picture -- SWEEPS FOLDER` makes one of each of the page's faces, to be looked at.
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch, open, waitForSweep } from './browser.mjs';
import { startLive } from './programs.mjs';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const [input = join(kRoot, 'out/drive'), output = join(kRoot, 'docs/images/viewer.png')] = process.argv.slice(2).map((path) => resolve(path));
const kSettleMs = 3000; // until colours have followed the points
const kChartsMs = 30_000; // as long as the charts should be

const keys = (...list) => async (page) => {
  for (const key of list) await page.keyboard.press(key);
};

// Name: how the page is opened, what is done to it, how long then.
const kReadme = { view: { width: 1280, height: 720 }, act: keys('d'), wait: kChartsMs };
const kFaces = {
  page: {},
  light: { view: { scheme: 'light' } },
  dashboard: { act: keys('d'), wait: 15_000 },
  'dashboard-light': { view: { scheme: 'light' }, act: keys('d'), wait: 8000 },
  settings: { act: keys('s') },
  help: { act: keys('?') },
  top: { act: keys('3') },
  first: { act: keys('4') },
  phone: { view: { width: 390, height: 844 } },
  'phone-light': { view: { width: 390, height: 844, scheme: 'light' } },
  'phone-dashboard': { view: { width: 390, height: 844 }, act: keys('d'), wait: 8000 },
  'phone-help': { view: { width: 390, height: 844 }, act: keys('?') },
};

async function take(browser, url, file, { view = {}, act = async () => undefined, wait = kSettleMs }) {
  const { page, complaints, close } = await open(browser, url, view);
  await waitForSweep(page);
  await act(page);
  await page.waitForTimeout(wait);
  await page.screenshot({ path: file });
  await close();
  console.log(file);
  for (const complaint of complaints) console.error(`${file}: ${complaint}`);
}

const folder = mkdtempSync(join(tmpdir(), 'sweepcast-picture-'));
const live = await startLive(folder);
const browser = await launch();
try {
  live.send(input);
  if (output.endsWith('.png')) {
    await take(browser, live.url, output, kReadme);
  } else {
    mkdirSync(output, { recursive: true });
    for (const [name, face] of Object.entries(kFaces)) await take(browser, live.url, join(output, `${name}.png`), face);
  }
} catch (error) {
  error.message += live.said();
  throw error;
} finally {
  await browser.close();
  await live.stop();
  rmSync(folder, { recursive: true, force: true });
}
