// Four ways to look at a sweep, whose sensor is at the origin, x forward, y left, z up.
import { MOUSE, Object3D, PerspectiveCamera, TOUCH, Vector3 } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { View } from './state';

Object3D.DEFAULT_UP.set(0, 0, 1);

interface Pose {
  from: [number, number, number];
  at: [number, number, number];
}

const kPoses: Record<View, Pose> = {
  orbit: { from: [-22, -26, 20], at: [2, 0, -1] },
  follow: { from: [-17, 0, 8.5], at: [7, 0, -2.5] },
  top: { from: [0, 0, 75], at: [0.01, 0, 0] },
  first: { from: [0, 0, 0], at: [5, 0, -0.2] },
};

export class CameraRig {
  readonly camera = new PerspectiveCamera(55, 1, 0.1, 1000);
  private readonly controls: OrbitControls;
  private view: View = 'follow';

  /** `changed` is called whenever the picture is out of date. */
  constructor(element: HTMLElement, changed: () => void) {
    this.controls = new OrbitControls(this.camera, element);
    this.controls.zoomSpeed = 1.2;
    this.controls.touches = { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    this.controls.addEventListener('change', changed);
    this.show('follow');
  }

  show(view: View): void {
    this.view = view;
    const { from, at } = kPoses[view];
    const controls = this.controls;
    // A narrow screen sees less to both sides, so it steps back.
    const back = view === 'first' ? 1 : Math.min(Math.max(1.1 / this.camera.aspect, 1), 2);
    controls.target.set(...at);
    this.camera.position.set(...from).sub(controls.target).multiplyScalar(back).add(controls.target);
    controls.minDistance = view === 'first' ? 4.9 : 1;
    controls.maxDistance = view === 'first' ? 5.1 : 400;
    controls.enablePan = view !== 'first';
    controls.enableRotate = true;
    controls.minPolarAngle = 0;
    controls.maxPolarAngle = view === 'top' ? 0 : Math.PI * 0.98;
    controls.screenSpacePanning = view === 'top';
    controls.mouseButtons = {
      LEFT: view === 'top' ? MOUSE.PAN : MOUSE.ROTATE,
      MIDDLE: MOUSE.DOLLY,
      RIGHT: view === 'top' ? MOUSE.ROTATE : MOUSE.PAN,
    };
    controls.touches = { ONE: view === 'top' ? TOUCH.PAN : TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN };
    if (view === 'first') this.lookAround();
    // Forward is up when looked at from above.
    if (view === 'top') {
      this.camera.position.set(-0.01, 0, kPoses.top.from[2] * back);
      controls.target.set(0, 0, 0);
    }
    controls.update();
    if (view === 'first') this.stayAtSensor();
  }

  reset(): void {
    this.show(this.view);
  }

  resize(width: number, height: number): void {
    if (width === 0 || height === 0) return;
    const first = this.camera.aspect === 1;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (first) this.reset();
  }

  /** Places the camera for the next picture. */
  beforeDraw(): void {
    if (this.view === 'first') this.stayAtSensor();
  }

  // The controls turn around their target. At the sensor it is the target that must turn, so
  // after each change both are moved until the camera is at the sensor again.
  private stayAtSensor(): void {
    const way = new Vector3().subVectors(this.controls.target, this.camera.position);
    this.camera.position.set(0, 0, 0);
    this.controls.target.copy(way);
  }

  private lookAround(): void {
    this.controls.minPolarAngle = Math.PI * 0.2;
    this.controls.maxPolarAngle = Math.PI * 0.8;
  }
}
