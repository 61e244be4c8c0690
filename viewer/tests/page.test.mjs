// The page in a browser, against a server that misbehaves when told to.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before, test } from './limited.mjs';
import { launch, open, waitForSweep } from './browser.mjs';
import { comparePictures } from './pictures.mjs';
import { framesOf, makeDrive } from './made_sweeps.mjs';
import { MockServer } from './mock_server.mjs';

const kAxe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const kSweeps = 12;

let browser;
let drive;
let sweeps;
before(async () => {
  drive = makeDrive(kSweeps);
  sweeps = framesOf(drive, '--level', '3');
  browser = await launch();
});
after(async () => {
  await browser?.close();
  drive?.done();
});

/** Starts a server, opens the page on it, runs `body`, and asserts that nothing was complained of. */
async function withPage(body, { mock = {}, view = {} } = {}) {
  const server = new MockServer(sweeps, mock);
  await server.start();
  const opened = await open(browser, `http://127.0.0.1:${server.port}/`, view);
  try {
    await waitForSweep(opened.page);
    await body(opened.page, server);
    assert.deepEqual(opened.complaints, []);
  } finally {
    await opened.close();
    await server.stop();
  }
}

const text = (page, id) => page.textContent(`#${id}`);
const placeIs = (page, place) => page.waitForFunction((wanted) => document.getElementById('place').textContent === wanted, place);
const said = (page, pattern) => page.waitForFunction((source) => new RegExp(source).test(document.getElementById('banner').textContent), pattern.source);

test('a file plays, pauses, steps, scrubs and changes speed', () =>
  withPage(async (page, server) => {
    assert.equal(await text(page, 'title'), 'drive.sweep');
    assert.match(await text(page, 'fact-points'), /^\d\d,\d\d\d$/);
    const first = await text(page, 'place');
    await page.waitForFunction((was) => document.getElementById('place').textContent !== was, first);
    await page.click('#play');
    await page.waitForFunction(() => document.getElementById('play').getAttribute('aria-label') === 'Play');
    await page.fill('#scrub', '4');
    await placeIs(page, `5 / ${kSweeps}`);
    await page.click('#forward');
    await placeIs(page, `6 / ${kSweeps}`);
    await page.focus('#view');
    await page.keyboard.press('ArrowLeft');
    await placeIs(page, `5 / ${kSweeps}`);
    await page.keyboard.press('End');
    await placeIs(page, `${kSweeps} / ${kSweeps}`);
    await page.keyboard.press('+');
    await page.waitForFunction(() => document.getElementById('speed').value === '2');
    const asked = server.received.map((message) => message.kind);
    for (const kind of ['more', 'pause', 'seek', 'speed']) assert.ok(asked.includes(kind), kind);
    // Flow control: every sweep that was shown is answered by room for one more, two are ahead.
    const granted = server.received.filter(({ kind }) => kind === 'more').reduce((sum, { count }) => sum + count, 0);
    const [client] = server.clients;
    assert.ok(client.credit >= 1 && client.credit <= 2, `${client.credit} of ${granted} are open`);
  }));

test('a damaged frame is named, and the next ones are shown', () =>
  withPage(async (page, server) => {
    server.damaged.add(3);
    await said(page, /Sweep 3 \(000003\) is damaged/);
    await placeIs(page, `6 / ${kSweeps}`);
  }));

test('notices of the server are shown, and can be put away', () =>
  withPage(async (page, server) => {
    server.say({ kind: 'notice', level: 'warning', text: 'the disk is nearly full' });
    await said(page, /the disk is nearly full/);
    await page.click('#banner .close');
    await page.waitForFunction(() => document.getElementById('banner').textContent === '');
    server.say({ kind: 'a kind of tomorrow', text: 'not understood' });
    server.say({ kind: 'notice', level: 'error', text: 'still listening' });
    await said(page, /still listening/);
  }));

test('a live stream that stops is said to have stopped, until it goes on', () =>
  withPage(
    async (page, server) => {
      assert.equal(await text(page, 'badge'), 'live');
      assert.ok(await page.isHidden('#transport'));
      server.silent = true;
      await said(page, /No sweep has arrived for over 3 s/);
      server.silent = false;
      await page.waitForFunction(() => document.getElementById('banner').textContent === '');
    },
    { mock: { live: true } },
  ));

test('after the server was away the page goes on by itself, where it was', async () => {
  const server = new MockServer(sweeps);
  await server.start();
  const opened = await open(browser, `http://127.0.0.1:${server.port}/`, { ignore: /ERR_CONNECTION_REFUSED|WebSocket connection/ });
  const { page } = opened;
  let again;
  try {
    await waitForSweep(page);
    await page.click('#play');
    await page.fill('#scrub', '7');
    await placeIs(page, `8 / ${kSweeps}`);
    // Until the page has room again it still has sweeps to show.
    const [client] = server.clients;
    while (client.index !== 7 || client.due || client.credit < 2) await page.evaluate(() => new Promise(requestAnimationFrame));
    await server.stop();
    await said(page, /No connection to the server/);
    again = new MockServer(sweeps);
    await again.start(server.port);
    await page.waitForFunction(() => document.getElementById('banner').textContent === '');
    await placeIs(page, `8 / ${kSweeps}`);
    await page.click('#forward');
    await placeIs(page, `9 / ${kSweeps}`);
    assert.deepEqual(opened.complaints, []);
  } finally {
    await opened.close();
    await (again ?? server).stop();
  }
});

test('without WebGL the page says what to do', async () => {
  const server = new MockServer(sweeps);
  await server.start();
  const context = await browser.newContext();
  try {
    const page = await context.newPage();
    await page.addInitScript(() => (HTMLCanvasElement.prototype.getContext = () => null));
    await page.goto(`http://127.0.0.1:${server.port}/`);
    await said(page, /offers no WebGL/);
  } finally {
    await context.close();
    await server.stop();
  }
});

test('where the decoder does not start, the page says that it is not the sweeps', async () => {
  const server = new MockServer(sweeps);
  await server.start();
  const { page, close } = await open(browser, 'about:blank');
  try {
    await page.route('**/*.wasm', (route) => route.fulfill({ status: 200, body: 'no WebAssembly' }));
    await page.goto(`http://127.0.0.1:${server.port}/`);
    await said(page, /The decoder does not work in this browser/);
    await assert.rejects(waitForSweep(page), /the page says: The decoder does not work/);
  } finally {
    await close();
    await server.stop();
  }
});

test('errors against the original, and both side by side', () =>
  withPage(
    async (page) => {
      await page.click('#play');
      await page.selectOption('#mode', 'error');
      await page.waitForFunction(() => /nearest original/.test(document.getElementById('legend-text').textContent));
      // Level 3's steps are centimetres; nothing would be 0, everything lost 1 m.
      const [low, high] = [parseFloat(await text(page, 'legend-low')), parseFloat(await text(page, 'legend-high'))];
      assert.match(await text(page, 'legend-high'), / cm$/);
      assert.ok(low === 0 && high > 0.1 && high < 60, `${low} to ${high} cm`);
      await page.click('#open-settings');
      await page.check('#side');
      await page.waitForSelector('#labels:not([hidden])');
      assert.match(await text(page, 'labels'), /Original.*Decoded/);
    },
    { mock: { original: (i) => drive.original(i) } },
  ));

test('without an original the error view says so', () =>
  withPage(async (page) => {
    await page.selectOption('#mode', 'error');
    await page.waitForFunction(() => /has no original/.test(document.getElementById('legend-text').textContent));
  }));

test('filled points are counted apart', () =>
  withPage(async (page) => {
    await page.click('#play');
    await page.click('#open-settings');
    await page.check('#fill');
    await page.waitForFunction(() => /\+ [\d,]+ filled/.test(document.getElementById('fact-points').textContent));
    assert.ok(await page.isVisible('#legend-filled'));
  }));

test('a point that is clicked tells its numbers', () =>
  withPage(async (page) => {
    await page.click('#play');
    await page.keyboard.press('3');
    const box = await page.locator('#view').boundingBox();
    let found = false;
    for (let step = 0; step < 30 && !found; ++step) {
      await page.mouse.click(box.x + box.width / 2 + 8 * step, box.y + box.height * 0.45);
      found = await page.isVisible('#pick');
    }
    assert.ok(found, 'no point was found');
    const facts = await page.textContent('#pick dl');
    const [, x, y, z, range] = facts.match(/\(x\)(-?[\d.]+) m.*\(y\)(-?[\d.]+) m.*\(z\)(-?[\d.]+) mrange([\d.]+) m/);
    assert.ok(Math.abs(Math.hypot(x, y, z) - range) < 0.002, facts);
    assert.match(facts, /measured/);
  }));

const robotsSay = (page, pattern) => page.waitForFunction((source) => new RegExp(source).test(document.getElementById('robots').textContent), pattern.source);

test('the dashboard draws a robot, and its level can be chosen, with keys alone', () =>
  withPage(
    async (page, server) => {
      await page.keyboard.press('d');
      await page.waitForSelector('#charts canvas');
      await robotsSay(page, /level [12] · queue \d.*dropped, \d+ before they left · QoE \d+\.\d/);
      assert.equal(await page.locator('#charts figure canvas').count(), 7);
      const choice = page.getByLabel('Level of rover');
      const isChosen = (value) => page.waitForFunction((wanted) => document.querySelector('#robots select').value === wanted, value);
      await page.focus('#dashboard .close');
      await page.keyboard.press('Tab');
      assert.ok(await choice.evaluate((select) => select === document.activeElement), 'Tab leads to the choice');
      await page.keyboard.type('3');
      await isChosen('3');
      await robotsSay(page, /level 3/);
      await page.waitForFunction(() => document.querySelector('#robots .outcome').textContent === '');
      await isChosen('3');
      await choice.selectOption('automatic');
      await robotsSay(page, /level [12] /);
      await isChosen('');
      const wishes = server.received.filter(({ kind }) => kind === 'override');
      assert.deepEqual(wishes, [{ kind: 'override', robot: 'rover', level: 3 }, { kind: 'override', robot: 'rover', level: null }]);
    },
    { mock: { live: true } },
  ));

test('a level that somebody else asked for is shown, and one that is not followed is taken back', () =>
  withPage(
    async (page, server) => {
      server.level = 5;
      await page.keyboard.press('d');
      const isChosen = (value) => page.waitForFunction((wanted) => document.querySelector('#robots select')?.value === wanted, value);
      await isChosen('5');
      server.hear = () => {}; // deaf
      await page.getByLabel('Level of rover').selectOption('0');
      await robotsSay(page, /the robot did not follow/);
      await isChosen('5');
    },
    { mock: { live: true } },
  ));

test('without the right there is no choice of levels', () =>
  withPage(
    async (page) => {
      await page.keyboard.press('d');
      await robotsSay(page, /level [12] · queue/);
      assert.ok(await page.isHidden('#robots select'));
    },
    { mock: { live: true, obeys: false } },
  ));

test('what a sender does not tell is said to be not reported', () =>
  withPage(
    async (page) => {
      await page.keyboard.press('d');
      await robotsSay(page, /level, queue, QoE not reported/);
      assert.equal(await page.locator('#charts figure').count(), 7);
      assert.deepEqual(await page.locator('#charts figure:has(.unknown) b').allTextContents(), ['Level', 'Queue', 'QoE']);
      assert.ok(await page.isHidden('#robots select'));
    },
    { mock: { live: true, reports: false } },
  ));

test('a saved picture is a PNG', () =>
  withPage(async (page) => {
    const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('p')]);
    assert.match(download.suggestedFilename(), /^sweepcast-\d{6}\.png$/);
    const bytes = readFileSync(await download.path());
    assert.equal(bytes.toString('latin1', 1, 4), 'PNG');
    assert.ok(bytes.length > 10_000);
  }));

for (const scheme of ['dark', 'light']) {
  for (const [width, height] of [[1280, 800], [390, 844]]) {
    test(`accessible at ${width} x ${height}, ${scheme}`, () =>
      withPage(
        async (page) => {
          const check = async (where) => {
            const { violations } = await page.evaluate(`${kAxe}; axe.run()`);
            assert.deepEqual(violations.map(({ id, nodes }) => `${where}: ${id}: ${nodes[0].html}`), []);
          };
          await check('page');
          await page.click('#open-settings');
          await check('settings');
          await page.click('#settings .close');
          await page.click('#open-dashboard');
          await page.waitForSelector('#charts canvas');
          await check('dashboard');
          await page.click('#dashboard .close');
          await page.click('#open-help');
          await check('help');
          const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
          assert.ok(!wide, 'the page scrolls sideways');
        },
        { mock: { live: true }, view: { width, height, scheme } },
      ));
  }
}

test('the picture is the one in the repository, within tolerance', () =>
  withPage(
    async (page) => {
      await page.click('#play');
      await page.fill('#scrub', '2');
      await placeIs(page, `3 / ${kSweeps}`);
      await page.keyboard.press('s');
      await page.uncheck('#range-auto');
      await page.fill('#range-low', '-2');
      await page.fill('#range-high', '6');
      await page.click('#settings .close');
      await page.click('#views [data-view=orbit]');
      await page.waitForFunction(() => document.getElementById('legend-high').textContent === '6 m');
      for (let frame = 0; frame < 3; ++frame) await page.evaluate(() => new Promise(requestAnimationFrame));
      // The letters on top are the system's, so only the points are compared.
      await page.evaluate(() => document.querySelectorAll('#stage > :not(canvas)').forEach((element) => (element.style.visibility = 'hidden')));
      await comparePictures(await page.locator('#view').screenshot(), new URL('pictures/view.png', import.meta.url));
    },
    { view: { width: 640, height: 480 } },
  ));
