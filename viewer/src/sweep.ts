// A sweep on its way from the server to the screen.
import type { Cloud } from './wasm_decoder';
import type { SweepMessage } from './wire';

/** What the sensor measured before anything was coded. */
export interface Original {
  points: number;
  xyz: Float32Array;
  intensity: Float32Array | null;
}

export interface Shown {
  message: SweepMessage;
  cloud: Cloud;
  errors: Float32Array | null; // metres, against the original
  original: Original | null;
  decodeMs: number;
}

/** An original seen as a decoded cloud, so that both are drawn alike. */
export function asCloud(original: Original, like: Cloud): Cloud {
  return { ...like, points: original.points, xyz: original.xyz, intensity: original.intensity, ring: null, timeNs: null, filled: null };
}
