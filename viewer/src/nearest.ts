// How far decoded points lie from the original: the distance to the nearest original point, found
// in a grid of cubes.

/** Distances beyond it are given as it, metres. */
export const kLargestError = 1;

const kFirstReach = 0.0625; // metres; then four times as much, up to the largest error

/** Original points, in cubes of one size, found by hash. */
class CubeGrid {
  private readonly mask: number;
  private readonly begin: Uint32Array; // of each bucket, in `order`
  private readonly order: Uint32Array; // points by bucket

  constructor(
    private readonly xyz: Float32Array,
    private readonly cube: number, // its edge, metres
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

  /**
   * The squared distance to the nearest point of the eight cubes around, which hold all points
   * within half a cube's edge; infinite without one.
   */
  nearest(x: number, y: number, z: number): number {
    const { xyz, begin, order } = this;
    const [cx, cy, cz] = [this.first(x), this.first(y), this.first(z)];
    let least = Infinity;
    for (let corner = 0; corner < 8; ++corner) {
      const bucket = this.bucketOf(cx + (corner & 1), cy + ((corner >> 1) & 1), cz + (corner >> 2));
      const end = begin[bucket + 1]!;
      for (let at = begin[bucket]!; at < end; ++at) {
        const i = order[at]! * 3;
        const ex = xyz[i]! - x;
        const ey = xyz[i + 1]! - y;
        const ez = xyz[i + 2]! - z;
        const squared = ex * ex + ey * ey + ez * ez;
        if (squared < least) least = squared;
      }
    }
    return least;
  }

  // Of the two cubes along an axis that are nearest to `value`, the lower one.
  private first(value: number): number {
    return Math.floor(value / this.cube - 0.5);
  }
}

/** For each point of `decoded` its distance to the nearest of `original`, metres; NaN without one. */
export function errorsAgainst(decoded: Float32Array, original: Float32Array): Float32Array {
  const errors = new Float32Array(decoded.length / 3).fill(kLargestError);
  if (original.length === 0) return errors.fill(NaN);
  let open = Uint32Array.from(errors.keys()); // points whose nearest is not known yet
  for (let reach = kFirstReach; reach <= kLargestError && open.length > 0; reach *= 4) {
    const grid = new CubeGrid(original, 2 * reach);
    open = open.filter((i) => {
      const squared = grid.nearest(decoded[3 * i]!, decoded[3 * i + 1]!, decoded[3 * i + 2]!);
      if (squared > reach * reach) return true; // another one outside the cubes may be nearer
      errors[i] = Math.sqrt(squared);
      return false;
    });
  }
  return errors;
}
