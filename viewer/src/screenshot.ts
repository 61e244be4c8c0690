// A picture of what is on the screen, with its legend, as a PNG file.
import { colourAt } from './colour';
import { kModes } from './scalars';
import type { SweepScene } from './scene';
import type { Settings } from './state';

const kLegend = { width: 220, height: 10, margin: 16 };

/** Draws once more, and offers the picture as a download. */
export function saveScreenshot(scene: SweepScene, canvas: HTMLCanvasElement, settings: Readonly<Settings>): void {
  scene.draw(); // what a canvas shows lasts only until the end of the task
  const picture = document.createElement('canvas');
  picture.width = canvas.width;
  picture.height = canvas.height;
  const context = picture.getContext('2d')!;
  context.drawImage(canvas, 0, 0);
  drawLegend(context, scene, settings, canvas.width / canvas.clientWidth);
  picture.toBlob((blob) => {
    if (!blob) return;
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    const newest = scene.newest;
    link.download = `sweepcast-${newest?.message.name || (newest?.message.index ?? 0)}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }, 'image/png');
}

function drawLegend(context: CanvasRenderingContext2D, scene: SweepScene, settings: Readonly<Settings>, scale: number): void {
  const { width, height, margin } = kLegend;
  const info = kModes[settings.mode];
  context.save();
  context.scale(scale, scale);
  context.translate(margin, context.canvas.height / scale - margin - height - 18);
  for (let x = 0; x < width; ++x) {
    const [r, g, b] = colourAt(settings.map, x / (width - 1));
    context.fillStyle = `rgb(${r} ${g} ${b})`;
    context.fillRect(x, 0, 1, height);
  }
  context.fillStyle = settings.dark ? '#e6e9ee' : '#1b2027';
  context.font = '12px system-ui, sans-serif';
  context.fillText(`${info.label}${info.unit ? `, ${info.unit}` : ''}`, 0, -6);
  context.fillText(scene.range[0].toFixed(1), 0, height + 14);
  context.textAlign = 'right';
  context.fillText(scene.range[1].toFixed(1), width, height + 14);
  context.restore();
}
