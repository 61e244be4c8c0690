// The page: puts its parts together. From here it reads top to bottom what happens when.
import './style.css';
import { Banner } from './banner';
import { Controls } from './controls';
import { Dashboard } from './dashboard';
import { Decoder } from './decoder';
import { byId, bytesText, countText } from './dom';
import { History, LocalMeter } from './history';
import { listenForKeys } from './keys';
import { Legend } from './legend';
import { Picker } from './picker';
import { Pipeline } from './pipeline';
import { SweepScene } from './scene';
import { saveScreenshot } from './screenshot';
import { Connection } from './socket';
import { firstSettings, Store } from './state';
import type { Shown } from './sweep';
import { Transport } from './transport';
import type { Hello, ServerMessage, SweepMessage } from './wire';

const kSilenceS = 3; // without a sweep from a live robot

const store = new Store(firstSettings());
const canvas = byId<HTMLCanvasElement>('view');
const banner = new Banner();
const history = new History();
let hello: Hello | null = null;
let greeted = false; // by the connection at hand
let lastArrival = performance.now();
const arrivals: number[] = []; // of the last seconds, for the rate

const scene = makeScene();
const connection = new Connection({ onOpen, onLost, onMessage, onSweep });
const send = connection.send.bind(connection);
const transport = new Transport(send);
const controls = new Controls(store);
const dashboard = new Dashboard(store, history, send);
const meter = new LocalMeter();
const picker = new Picker(scene, canvas, byId('pick'), byId('pick-ring'));
const pipeline = new Pipeline(new Decoder(), () => store.get(), { wants, show, damaged, failed, lackOriginal, done: () => connection.grant() });
new Legend(store, scene);

store.watch((settings, changed) => {
  scene.apply(settings, changed);
  byId('labels').hidden = !settings.sideBySide;
  if (changed.has('stream')) scene.clear();
  const needs = ['fill', 'sideBySide', 'mode'] as const;
  if (needs.some((key) => changed.has(key))) pipeline.again();
});

listenForKeys(store, {
  playOrPause: () => transport.toggle(),
  step: (by) => transport.step(by),
  seek: (to) => transport.seek(to === 'begin' ? 0 : Infinity),
  faster: (by) => transport.faster(by),
  resetView: () => scene.rig.reset(),
  screenshot,
  escape: () => picker.close(),
});
byId('screenshot').addEventListener('click', screenshot);
byId('reset').addEventListener('click', () => scene.rig.reset());
byId('pick').querySelector('.close')!.addEventListener('click', () => picker.close());
canvas.addEventListener('pointerdown', () => (byId('hint').hidden = true), { once: true });
setInterval(everySecond, 1000);
connection.open();

function makeScene(): SweepScene {
  try {
    return new SweepScene(canvas, store.get());
  } catch (error) {
    byId('waiting').hidden = true;
    banner.say('page', 'error', 'This browser cannot draw in three dimensions: it offers no WebGL. Turn on hardware acceleration, or use another browser.');
    throw error;
  }
}

function onOpen(): void {
  greeted = false;
  banner.clear('connection');
  lastArrival = performance.now();
  setBadge('connected', '');
}

function onLost(waitMs: number): void {
  pipeline.clear();
  banner.clear('stall');
  setBadge('off', 'not connected');
  const wait = waitMs < 1000 ? 'now' : `in ${Math.round(waitMs / 1000)} s`;
  banner.say('connection', 'error', `No connection to the server. Trying again ${wait}; start it again if it was stopped.`);
}

function onMessage(message: ServerMessage): void {
  switch (message.kind) {
    case 'hello':
      return begin(message);
    case 'status':
      history.add(message.time_s, message.robots);
      return dashboard.update();
    case 'state':
      return transport.setState(message);
    case 'notice':
      return banner.say('server', message.level, message.text, message.level !== 'error');
  }
}

// The first words of a connection, or news of its streams.
function begin(message: Hello): void {
  const cameBack = !greeted && hello?.source === 'file' && hello.frames === message.frames;
  greeted = true;
  hello = message;
  scene.rateHz = message.rate_hz;
  const title = titleOf(message);
  byId('title').textContent = title;
  document.title = `${title || 'sweeps'} – Sweepcast`;
  setBadge(message.source, message.source === 'live' ? 'live' : 'file');
  controls.offer(message.source === 'live' ? message.streams : [], message.has_original);
  const position = transport.position;
  transport.setFrames(message.source === 'file' ? message.frames : null);
  dashboard.begin(message);
  byId('waiting').hidden = scene.newest !== null;
  byId('waiting').textContent =
    message.streams.length === 0 ? 'Waiting for a robot to connect …' : 'Waiting for the first sweep …';
  // After the server was started again a file goes on where it was; paused first, or it would go on from there.
  if (cameBack && message.source === 'file') {
    send({ kind: position.playing ? 'play' : 'pause' });
    transport.seek(position.index);
  }
}

// Live, the robots are what there is to name.
function titleOf({ source, title, streams }: Hello): string {
  return source === 'live' ? [...new Set(streams.map(({ robot }) => robot))].join(', ') : title;
}

function onSweep(sweep: SweepMessage): void {
  lastArrival = performance.now();
  banner.clear('stall');
  meter.add(sweep.frame.length);
  pipeline.add(sweep);
}

// Files follow one another; of robots one is looked at.
function wants(sweep: SweepMessage): boolean {
  return hello?.source === 'file' || sweep.stream === store.get().stream;
}

async function show(sweep: Shown): Promise<void> {
  byId('waiting').hidden = true;
  arrivals.push(performance.now());
  if (scene.newest && scene.newest.message.stream !== sweep.message.stream) scene.clear();
  const drawn = scene.show(sweep);
  transport.setShown(sweep.message.index);
  showFacts(sweep);
  await drawn;
}

function damaged(sweep: SweepMessage, message: string): void {
  const which = sweep.name ? `${sweep.index} (${sweep.name})` : String(sweep.index);
  banner.say('frame', 'error', `Sweep ${which} is damaged: ${message}. It is left out; the others are shown.`, true);
}

function failed(message: string): void {
  banner.say('page', 'error', `The decoder does not work in this browser (${message}). Load the page again; if that does not help, use another browser.`);
}

function lackOriginal(message: string): void {
  banner.say('page', 'warning', `The original of this sweep could not be fetched (${message}); only the decoded sweep is shown.`, true);
}

function showFacts({ message, cloud, decodeMs }: Shown): void {
  const coded = cloud.counts.pointsIn;
  const filled = cloud.filled ? cloud.filled.reduce((sum, one) => sum + one, 0) : 0;
  byId('fact-points').textContent = countText(cloud.points - filled) + (filled > 0 ? ` + ${countText(filled)} filled` : '');
  byId('fact-bytes').textContent = bytesText(message.frame.length);
  byId('fact-ratio').textContent = message.frame.length > 0 ? `${((coded * 16) / message.frame.length).toFixed(0)}×` : '–';
  byId('fact-decode').textContent = `${decodeMs.toFixed(0)} ms`;
  const live = hello?.source === 'live';
  byId('fact-age').textContent = live ? `${message.ageMs} ms` : '–';
  byId('fact-age').parentElement!.hidden = !live;
  const { layersPresent, layersMade } = message;
  byId('fact-layers').textContent = layersMade > 0 ? `${layersPresent} of ${layersMade}` : '–';
}

function everySecond(): void {
  const now = performance.now();
  while (arrivals.length > 0 && now - arrivals[0]! > 3000) arrivals.shift();
  byId('fact-rate').textContent = arrivals.length > 0 ? `${(arrivals.length / 3).toFixed(1)} Hz` : '–';
  if (hello?.source === 'file') {
    history.add(now / 1000, [meter.take('this page')]);
    dashboard.update();
  }
  const silence = (now - lastArrival) / 1000;
  if (hello?.source === 'live' && hello.streams.length > 0 && silence > kSilenceS && !document.hidden) {
// A number that changes every second would be read aloud every second.
    const over = silence < 10 ? kSilenceS : Math.floor(silence / 10) * 10;
    banner.say('stall', 'warning', `No sweep has arrived for over ${over} s. The robot may have stopped, or its link is down; the last sweep is shown.`);
  }
}

function setBadge(kind: string, text: string): void {
  const badge = byId('badge');
  badge.dataset['kind'] = kind;
  if (text) badge.textContent = text;
}

function screenshot(): void {
  saveScreenshot(scene, canvas, store.get());
}
