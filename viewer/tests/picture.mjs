// Makes a picture of the page: `npm run picture -- INPUT OUT.png [INDEX]`, INPUT as for `sweepcast view`.
import { launch, open, waitForSweep } from './browser.mjs';
import { freePort, startView } from './programs.mjs';

const [input, output, index = '0'] = process.argv.slice(2);
if (!output) {
  console.error('usage: npm run picture -- INPUT OUT.png [INDEX]');
  process.exit(2);
}
const view = await startView(await freePort(), input);
const browser = await launch();
try {
  const { page } = await open(browser, view.url, { width: 1280, height: 720 });
  await waitForSweep(page);
  await page.click('#play');
  await page.fill('#scrub', index);
  await page.waitForFunction((place) => document.getElementById('place').textContent.startsWith(place), `${Number(index) + 1} /`);
  await page.waitForTimeout(2000); // until the colours have settled
  await page.screenshot({ path: output });
} finally {
  await browser.close();
  await view.stop();
}
