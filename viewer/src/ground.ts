// What gives a cloud its scale: a grid near the ground, and axes at the sensor.
import { ArrowHelper, BufferGeometry, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Vector3 } from 'three';

const kSensorHeight = 1.73; // metres; of a car's sensor, where nothing is known
const kReach = 100;
const kStep = 10;
const kAxis = 2.5;

// Cell by cell: a line that passes the camera as a whole is lost with some drivers.
function gridOf(lines: (at: number) => boolean): BufferGeometry {
  const places: number[] = [];
  for (let at = -kReach; at <= kReach; at += kStep) {
    if (!lines(at)) continue;
    for (let from = -kReach; from < kReach; from += kStep) {
      places.push(at, from, 0, at, from + kStep, 0, from, at, 0, from + kStep, at, 0);
    }
  }
  return new BufferGeometry().setAttribute('position', new Float32BufferAttribute(places, 3));
}

export class Ground {
  readonly object = new Group();
  private readonly fine = new LineSegments(gridOf((at) => at % 50 !== 0), new LineBasicMaterial());
  private readonly bold = new LineSegments(gridOf((at) => at % 50 === 0), new LineBasicMaterial());

  constructor() {
    this.object.add(this.fine, this.bold);
    this.object.position.z = -kSensorHeight;
  }

  paint(dark: boolean): void {
    this.fine.material.color.set(dark ? 0x252c35 : 0xd3d8df);
    this.bold.material.color.set(dark ? 0x46505e : 0xa2abb8);
  }
}

/** Red forward, green left, blue up. */
export function makeAxes(): Group {
  const axes = new Group();
  const origin = new Vector3();
  for (const [way, colour] of [[new Vector3(1, 0, 0), 0xf0443e], [new Vector3(0, 1, 0), 0x2fb344], [new Vector3(0, 0, 1), 0x3b82f6]] as const) {
    axes.add(new ArrowHelper(way, origin, kAxis, colour, 0.5, 0.3));
  }
  return axes;
}
