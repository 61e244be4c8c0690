// What points may be coloured by: one number a point.
import type { Shown } from './sweep';

export type Mode = 'height' | 'range' | 'intensity' | 'ring' | 'age' | 'error';

export interface ModeInfo {
  label: string;
  unit: string;
  explanation: string;
}

export const kModes: Record<Mode, ModeInfo> = {
  height: { label: 'Height', unit: 'm', explanation: 'How far above or below the sensor a point lies.' },
  range: { label: 'Range', unit: 'm', explanation: 'How far from the sensor a point lies.' },
  intensity: { label: 'Intensity', unit: '', explanation: 'How brightly the surface sent the laser back.' },
  ring: { label: 'Ring', unit: '', explanation: 'Which laser of the sensor saw the point; 0 is the first.' },
  age: { label: 'Age', unit: 's', explanation: 'How long ago, before the end of the newest sweep, a point was measured.' },
  error: { label: 'Error', unit: 'cm', explanation: 'Distance from a decoded point to the nearest original one.' },
};

/**
 * The numbers of a sweep's points; null where it does not have them. `ageS`: seconds between the
 * end of this sweep and the end of the newest.
 */
export function scalarsOf(sweep: Shown, mode: Mode, ageS: number): Float32Array | null {
  const { xyz, points } = sweep.cloud;
  const values = new Float32Array(points);
  switch (mode) {
    case 'height':
      for (let i = 0; i < points; ++i) values[i] = xyz[3 * i + 2]!;
      return values;
    case 'range':
      for (let i = 0; i < points; ++i) values[i] = Math.hypot(xyz[3 * i]!, xyz[3 * i + 1]!, xyz[3 * i + 2]!);
      return values;
    case 'intensity':
      return sweep.cloud.intensity;
    case 'ring':
      return sweep.cloud.ring ? Float32Array.from(sweep.cloud.ring) : null;
    case 'age': {
      const times = sweep.cloud.timeNs;
      if (!times) return values.fill(ageS);
      let last = 0;
      for (const time of times) last = Math.max(last, time);
      for (let i = 0; i < points; ++i) values[i] = ageS + (last - times[i]!) / 1e9;
      return values;
    }
    case 'error':
      if (!sweep.errors) return null;
      for (let i = 0; i < points; ++i) values[i] = sweep.errors[i]! * 100;
      return values;
  }
}

/** A range of colours that shows most of the values: a few strays do not squeeze the rest. */
export function rangeOf(values: Float32Array, mode: Mode): [number, number] {
  const stride = Math.max(1, Math.floor(values.length / 20000));
  const sample: number[] = [];
  for (let i = 0; i < values.length; i += stride) {
    if (Number.isFinite(values[i]!)) sample.push(values[i]!);
  }
  if (sample.length === 0) return [0, 1];
  sample.sort((a, b) => a - b);
  const at = (share: number) => sample[Math.round(share * (sample.length - 1))]!;
  const whole = mode === 'ring' || mode === 'age';
  const low = mode === 'error' || mode === 'range' ? 0 : at(whole ? 0 : 0.01);
  const high = at(whole ? 1 : 0.98);
  return high > low ? [low, high] : [low, low + 1];
}
