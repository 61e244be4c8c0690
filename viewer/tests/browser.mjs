// Debian's Chromium, without a screen and with WebGL in software.
import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const kChromium = process.env.CHROMIUM ?? '/usr/bin/chromium';
const kFlags = [
  '--headless=new', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
];

export async function launch() {
  if (!existsSync(kChromium)) throw new Error(`${kChromium} is missing; apt-get install chromium, or set CHROMIUM`);
  return chromium.launch({ executablePath: kChromium, args: kFlags });
}

/**
 * Opens the page. What it complains about, and requests to other hosts, gather in `complaints`;
 * `ignore` names what a test provokes.
 */
export async function open(browser, url, { width = 1280, height = 800, scheme = 'dark', ignore = null } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, reducedMotion: 'reduce' });
  context.setDefaultTimeout(60_000); // on a busy machine WebGL in software takes its time
  const page = await context.newPage();
  const complaints = [];
  const note = (text) => {
    if (text.includes('GPU stall due to ReadPixels')) return; // a screenshot was taken
    if (!ignore?.test(text)) complaints.push(text);
  };
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') note(message.text());
  });
  page.on('pageerror', (error) => note(String(error)));
  page.on('request', (request) => {
    if (!request.url().startsWith(new URL(url).origin) && !request.url().startsWith('blob:')) note(`asked for ${request.url()}`);
  });
  await page.goto(url);
  return { page, complaints, close: () => context.close() };
}

/** Waits until a sweep is on the screen; where the page says what is wrong, fails with its words. */
export async function waitForSweep(page) {
  const error = await page.waitForFunction(() => {
    if (document.getElementById('fact-points').textContent !== '–') return 'none';
    return document.querySelector('#banner .error span')?.textContent;
  });
  const words = await error.jsonValue();
  if (words !== 'none') throw new Error(`the page says: ${words}`);
}
