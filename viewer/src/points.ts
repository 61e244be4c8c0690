// One cloud on the graphics card: places, a number a point, and whether it was measured. Colours
// are looked up there, so that choosing another range or map costs nothing.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DynamicDrawUsage,
  LinearFilter,
  Points,
  RGBAFormat,
  ShaderMaterial,
  Vector2,
} from 'three';
import { colourRow, kMapEntries, type ColourMapName } from './colour';

const kVertexShader = `
  attribute float value;
  attribute float filled;
  uniform vec2 range;
  uniform float size;     // pixels of the screen, at 12 m
  uniform float nearest;  // times as large are points right before the camera
  varying float share;  // of the colour map
  varying float isFilled;
  void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    gl_Position = projectionMatrix * seen;
    // A point that is none (NaN) goes where nothing is drawn.
    if (!(dot(position, position) >= 0.0)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = size * clamp(12.0 / max(-seen.z, 0.1), 0.8, nearest) * (filled > 0.5 ? 0.75 : 1.0);
    share = clamp((value - range.x) / max(range.y - range.x, 1e-9), 0.0, 1.0);
    isFilled = filled;
  }`;

const kFragmentShader = `
  uniform sampler2D map;
  uniform float opacity;
  uniform vec3 filledColour;
  uniform vec3 plainColour;
  uniform float plain;
  varying float share;
  varying float isFilled;
  void main() {
    vec3 colour = texture2D(map, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
    if (plain > 0.5) colour = plainColour;
    gl_FragColor = vec4(isFilled > 0.5 ? filledColour : colour, opacity);
  }`;

/** What all clouds of a scene share: the map, its range, the size of points. */
export class PointStyle {
  readonly uniforms = {
    map: { value: new DataTexture(new Uint8Array(kMapEntries * 4), kMapEntries, 1, RGBAFormat) },
    range: { value: new Vector2(0, 1) },
    size: { value: 2 },
    nearest: { value: 2 },
    filledColour: { value: new Color() },
    plainColour: { value: new Color() },
  };

  constructor() {
    this.uniforms.map.value.minFilter = LinearFilter;
    this.uniforms.map.value.magFilter = LinearFilter;
  }

  setMap(name: ColourMapName, dark: boolean): void {
    const texture = this.uniforms.map.value;
    (texture.image.data as Uint8Array).set(colourRow(name, dark));
    texture.needsUpdate = true;
    const grey = (shade: number) => new Color(shade, shade * 1.03, shade * 1.08);
    this.uniforms.filledColour.value = grey(dark ? 0.52 : 0.55);
    this.uniforms.plainColour.value = grey(dark ? 0.7 : 0.35);
  }
}

export class PointsObject {
  readonly object: Points<BufferGeometry, ShaderMaterial>;
  private capacity = 0;

  constructor(style: PointStyle) {
    const material = new ShaderMaterial({
      vertexShader: kVertexShader,
      fragmentShader: kFragmentShader,
      uniforms: { ...style.uniforms, opacity: { value: 1 }, plain: { value: 0 } },
    });
    this.object = new Points(new BufferGeometry(), material);
    this.object.frustumCulled = false;
  }

  /** Shows so many points; `setValues` gives them their numbers. Copies what it is given. */
  set(points: number, xyz: Float32Array, filled: Uint8Array | null): void {
    if (points > this.capacity || this.capacity === 0) this.grow(Math.ceil(points * 1.1) + 1);
    this.fill('position', xyz);
    this.fill('filled', filled ?? new Uint8Array(points));
    this.object.geometry.setDrawRange(0, points);
  }

  /** What the points are coloured by; without numbers all are of one colour. */
  setValues(values: Float32Array | null): void {
    this.object.material.uniforms['plain']!.value = values ? 0 : 1;
    if (values) this.fill('value', values);
  }

  /** Older sweeps fade; those that do not are drawn without blending. */
  setOpacity(opacity: number): void {
    const material = this.object.material;
    material.uniforms['opacity']!.value = opacity;
    material.transparent = opacity < 1;
    material.depthWrite = opacity === 1;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }

  private grow(capacity: number): void {
    const geometry = this.object.geometry;
    geometry.dispose(); // frees the former buffers
    const add = (name: string, array: Float32Array | Uint8Array, size: number) => {
      const attribute = new BufferAttribute(array, size);
      attribute.setUsage(DynamicDrawUsage);
      geometry.setAttribute(name, attribute);
    };
    add('position', new Float32Array(capacity * 3), 3);
    add('value', new Float32Array(capacity), 1);
    add('filled', new Uint8Array(capacity), 1);
    this.capacity = capacity;
  }

  private fill(name: string, from: Float32Array | Uint8Array): void {
    const attribute = this.object.geometry.getAttribute(name) as BufferAttribute;
    (attribute.array as Float32Array).set(from);
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, from.length);
    attribute.needsUpdate = true;
  }
}
