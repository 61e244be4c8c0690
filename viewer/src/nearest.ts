// How far decoded points lie from the original: the distance to the nearest original point, found
// in a grid of cubes.

/** Distances beyond it are given as it, metres. */
export const kLargestError = 1;

const kFirstCube = 0.125; // metres; then four times as much, up to the largest error

/** Original points, in cubes of one size, found by hash. */
class CubeGrid {
  private readonly mask: number;
  private readonly begin: Uint32Array; // of each bucket, in `order`
  private readonly order: Uint32Array; // points by bucket

  constructor(
    private readonly xyz: Float32Array,
    private readonly cube: number,
  ) {
    const points = xyz.length / 3;
    let buckets = 1024;
    while (buckets < points) buckets *= 2;
    this.mask = buckets - 1;
    this.begin = new Uint32Array(buckets + 1);
    this.order = new Uint32Array(points);
    const bucket = new Uint32Array(points);
    for (let i = 0; i < points; ++i) {
      bucket[i] = this.bucketOf(this.place(xyz[3 * i]!), this.place(xyz[3 * i + 1]!), this.place(xyz[3 * i + 2]!));
      this.begin[bucket[i]! + 1]!++;
    }
    for (let b = 0; b < buckets; ++b) this.begin[b + 1]! += this.begin[b]!;
    const next = this.begin.slice();
    for (let i = 0; i < points; ++i) this.order[next[bucket[i]!]!++] = i;
  }

  private place(value: number): number {
    return Math.floor(value / this.cube);
  }

  private bucketOf(x: number, y: number, z: number): number {
    return (Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791)) & this.mask;
  }

  /** The squared distance to the nearest point of the 27 cubes around; infinite without one. */
  nearest(x: number, y: number, z: number): number {
    let least = Infinity;
    const [cx, cy, cz] = [this.place(x), this.place(y), this.place(z)];
    for (let dx = -1; dx <= 1; ++dx) {
      for (let dy = -1; dy <= 1; ++dy) {
        for (let dz = -1; dz <= 1; ++dz) {
          const bucket = this.bucketOf(cx + dx, cy + dy, cz + dz);
          for (let at = this.begin[bucket]!; at < this.begin[bucket + 1]!; ++at) {
            const i = this.order[at]! * 3;
            const ex = this.xyz[i]! - x;
            const ey = this.xyz[i + 1]! - y;
            const ez = this.xyz[i + 2]! - z;
            const squared = ex * ex + ey * ey + ez * ez;
            if (squared < least) least = squared;
          }
        }
      }
    }
    return least;
  }
}

/** For each point of `decoded` its distance to the nearest of `original`, metres; NaN without one. */
export function errorsAgainst(decoded: Float32Array, original: Float32Array): Float32Array {
  const errors = new Float32Array(decoded.length / 3).fill(kLargestError);
  if (original.length === 0) return errors.fill(NaN);
  for (let cube = kFirstCube, first = true; cube < 4 * kLargestError; cube *= 4, first = false) {
    const grid = new CubeGrid(original, Math.min(cube, kLargestError));
    const sure = Math.min(cube, kLargestError); // what lies nearer is in the 27 cubes for certain
    let missed = 0;
    for (let i = 0; i < errors.length; ++i) {
      if (!first && errors[i]! < kLargestError) continue;
      const squared = grid.nearest(decoded[3 * i]!, decoded[3 * i + 1]!, decoded[3 * i + 2]!);
      if (squared <= sure * sure) errors[i] = Math.sqrt(squared);
      else ++missed;
    }
    if (missed === 0) break;
  }
  return errors;
}
