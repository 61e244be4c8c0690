// Colour maps: a few colours each, and what lies between them.

export type ColourMapName = 'turbo' | 'viridis' | 'greys';

/** Evenly spaced, from the least value to the largest. */
const kStops: Record<ColourMapName, string[]> = {
  turbo: [
    '#30123b', '#4145ab', '#4675ed', '#39a2fc', '#1bcfd4', '#24eca6', '#61fc6c', '#a4fc3b',
    '#d1e834', '#f3c63a', '#fe9b2d', '#f36315', '#d93806', '#b11901', '#7a0402',
  ],
  viridis: [
    '#440154', '#482878', '#3e4989', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725',
  ],
  greys: ['#4a4a4a', '#f2f2f2'],
};

export const kColourMaps = Object.keys(kStops) as ColourMapName[];
export const kMapEntries = 256;

type Rgb = [number, number, number]; // 0 to 255, sRGB

function parse(hex: string): Rgb {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)) as Rgb;
}

/** The colour at `share`, 0 to 1, of a map. */
export function colourAt(map: ColourMapName, share: number): Rgb {
  const stops = kStops[map];
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const before = Math.min(Math.floor(place), stops.length - 2);
  const [from, to] = [parse(stops[before]!), parse(stops[before + 1]!)];
  return from.map((value, i) => Math.round(value + (to[i]! - value) * (place - before))) as Rgb;
}

/** The map as a row of pixels, red, green, blue and opacity, darkest entries lifted on `dark`. */
export function colourRow(map: ColourMapName, dark: boolean): Uint8Array {
  const row = new Uint8Array(kMapEntries * 4);
  for (let i = 0; i < kMapEntries; ++i) {
    const colour = legible(colourAt(map, i / (kMapEntries - 1)), dark);
    row.set([...colour, 255], i * 4);
  }
  return row;
}

/** As CSS has it, for a legend that shows what the points show. */
export function cssGradient(map: ColourMapName, dark: boolean): string {
  const steps = 24;
  const colours = Array.from({ length: steps + 1 }, (_, i) => {
    const [r, g, b] = legible(colourAt(map, i / steps), dark);
    return `rgb(${r} ${g} ${b})`;
  });
  return `linear-gradient(to right, ${colours.join(', ')})`;
}

// Points are a few pixels of one colour: the ends of a map must not sink into the ground, so what
// is too dark for a dark one, or too light for a light one, is moved just far enough.
function legible([r, g, b]: Rgb, dark: boolean): Rgb {
  const luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  const [least, most] = dark ? [70, 255] : [0, 175];
  if (luminance < least) {
    const lift = (least - luminance) / (255 - luminance);
    return [r, g, b].map((value) => Math.round(value + (255 - value) * lift)) as Rgb;
  }
  if (luminance > most) return [r, g, b].map((value) => Math.round((value * most) / luminance)) as Rgb;
  return [r, g, b];
}
