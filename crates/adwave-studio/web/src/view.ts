/**
 * The picture. The shape is drawn in one of three ways: as it was opened (`base`), after the edit with smooth normals as
 * the worker gave it (`edited`), or while something moves as base + bands summed by the shader (`live`).
 */

import {
  BufferAttribute,
  BufferGeometry,
  ColorManagement,
  DataTexture,
  DoubleSide,
  GLSL3,
  LinearFilter,
  LineSegments,
  Mesh,
  Points,
  RawShaderMaterial,
  Scene,
  Vector2,
  Vector3,
  Vector4,
  WebGLRenderer,
} from 'three';
import { Camera } from './camera';
import { type MapName, table } from './colours';
import { Compact } from './compact';
import type { Feature } from './protocol';
import {
  ballFragment,
  ballVertex,
  fragmentShader,
  lineFragment,
  lineVertex,
  maskPacks,
  type Variant,
  vertexShader,
} from './shader';

export type Style = 'shaded' | 'matcap' | 'flat' | 'edges';
export type Theme = 'light' | 'dark';

const COLOURS: Record<Theme, { surface: number; accent: number; paper: number; ink: number }> = {
  light: { surface: 0xd9d7d2, accent: 0x0b6bcb, paper: 0xf4f4f2, ink: 0x1b1d20 },
  dark: { surface: 0xbdbbb6, accent: 0x4aa3ff, paper: 0x17181a, ink: 0xf2f2f0 },
};

// Colours are those of the screen, as the style sheet has them; the shaders write them as they are.
ColorManagement.enabled = false;

/** Triangles up to which a moving shape is drawn in full: without and with a graphics processor. */
const MOVING_LIMIT = { software: 60_000, hardware: 4_000_000 };
/** Triangles from which the shader sums what moves. */
const LARGE = { software: 60_000, hardware: 300_000 };
/** Pixels of the picture a pixel of the screen while a large shape moves without a graphics processor. */
const MOVING_RATIO = 0.6;
/** Milliseconds after the last movement until all triangles are drawn again. */
const REST = 160;

export class View {
  readonly camera = new Camera();
  readonly renderer: WebGLRenderer;
  readonly rendererName: string;
  readonly software: boolean;
  style: Style = 'shaded';
  /** Shows the shape as it was opened. */
  before = false;
  /** Where the picture is divided into before and after, as part of its width; null: it is not. */
  split: number | null = null;
  live = false;
  /** Called after each frame that was drawn. */
  drawn: ((began: number) => void) | null = null;
  hasEdited = false;
  private theme: Theme = 'light';
  private readonly scene = new Scene();
  private readonly base = new BufferGeometry();
  private readonly edited = new BufferGeometry();
  private readonly lines = new BufferGeometry();
  private readonly ring: LineSegments<BufferGeometry, RawShaderMaterial>[] = [];
  private readonly balls: Points<BufferGeometry, RawShaderMaterial>;
  private body: Mesh<BufferGeometry, RawShaderMaterial> | Points<BufferGeometry, RawShaderMaterial> | null =
    null;
  private wires: LineSegments<BufferGeometry, RawShaderMaterial> | null = null;
  private readonly materials = new Map<string, RawShaderMaterial>();
  /** The edit as uniforms of the sum; their lengths are part of its shader. */
  private sums: Record<'gains' | 'scales' | 'slopes', { value: number[] }> = noSums();
  private packs = 0;
  private hasScalar = false;
  private tinted = false;
  private full: BufferAttribute | null = null;
  /** Fewer triangles, as opened and after the edit. */
  private coarse: { base: Compact; edited: Compact } | null = null;
  private nTriangles = 0;
  private n = 0;
  private nLevels = 0;
  private cloud = false;
  private pointSize = 1;
  private frame = 0;
  private moving = 0;
  private readonly tints = [new Vector4(), new Vector4()];
  private readonly texture: DataTexture;
  private readonly shared: Record<string, { value: unknown }>;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: false,
      alpha: false,
      powerPreference: 'high-performance',
    });
    const gl = this.renderer.getContext();
    const info = gl.getExtension('WEBGL_debug_renderer_info');
    this.rendererName = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
    this.software = /llvmpipe|swiftshader|softpipe|software|basic render/i.test(this.rendererName);
    // Without a graphics processor every pixel costs; with one, two by two pixels smooth the edges, and without
    // the memory that a multisampled picture takes.
    this.renderer.setPixelRatio(this.software ? 1 : Math.max(2, Math.min(3, devicePixelRatio)));
    this.renderer.autoClear = false;
    this.renderer.outputColorSpace = 'srgb-linear';
    this.texture = new DataTexture(table('viridis'), 256, 1);
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearFilter;
    this.texture.needsUpdate = true;
    this.shared = {
      surface: { value: new Vector3() },
      accent: { value: new Vector3() },
      range: { value: new Vector2(0, 1) },
      colours: { value: this.texture },
      tint: { value: this.tints[0] },
      tint1: { value: this.tints[1] },
      pointSize: { value: 1 },
    };
    for (const opacity of [1, 0.45]) {
      const ring = new LineSegments(new BufferGeometry(), lineMaterial(opacity, 0.0015));
      ring.frustumCulled = false;
      ring.visible = false;
      ring.renderOrder = 2;
      this.ring.push(ring);
      this.scene.add(ring);
    }
    this.balls = new Points(
      new BufferGeometry(),
      new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: ballVertex,
        fragmentShader: ballFragment,
        uniforms: {
          pixels: { value: 1 },
          high: { value: new Vector3(0.87, 0.43, 0.2) },
          low: { value: new Vector3(0.22, 0.48, 0.78) },
        },
      }),
    );
    this.balls.frustumCulled = false;
    this.balls.visible = false;
    this.scene.add(this.balls);
    this.setTheme('light');
  }

  private material(variant: Variant): RawShaderMaterial {
    const key = JSON.stringify(variant);
    let material = this.materials.get(key);
    if (!material) {
      material = new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: vertexShader(variant),
        fragmentShader: fragmentShader(variant),
        side: DoubleSide,
        uniforms: { ...this.shared, ...this.sums },
      });
      this.materials.set(key, material);
    }
    return material;
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    const colours = COLOURS[theme];
    (this.shared['surface']!.value as Vector3).set(...rgb(colours.surface));
    (this.shared['accent']!.value as Vector3).set(...rgb(colours.accent));
    this.renderer.setClearColor(colours.paper, 1);
    for (const [i, ring] of this.ring.entries()) {
      (ring.material.uniforms['ink']!.value as Vector4).set(...rgb(colours.ink), i === 0 ? 1 : 0.5);
    }
    this.request();
  }

  /** A new shape. Positions are relative to its centre. */
  setShape(positions: Float32Array, triangles: Uint32Array, cloud: boolean, meanLength: number): void {
    this.clear();
    this.n = positions.length / 3;
    this.cloud = cloud;
    this.nTriangles = triangles.length / 3;
    this.pointSize = meanLength * 1.4;
    this.base.setAttribute('position', new BufferAttribute(positions, 3));
    this.full = cloud ? null : new BufferAttribute(triangles, 1);
    this.base.setIndex(this.full);
    this.edited.setIndex(this.full);
    this.body = cloud
      ? new Points(this.base, new RawShaderMaterial())
      : new Mesh(this.base, new RawShaderMaterial());
    this.body.frustumCulled = false;
    this.scene.add(this.body);
    this.frameBounds(positions);
    this.request();
  }

  private frameBounds(p: Float32Array): void {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < p.length; i += 3) {
      for (let c = 0; c < 3; c++) {
        const x = p[i + c]!;
        if (x < low[c]!) low[c] = x;
        if (x > high[c]!) high[c] = x;
      }
    }
    const centre = low.map((x, c) => (x + high[c]!) / 2);
    let radius = 0;
    const [cx, cy, cz] = centre as [number, number, number];
    for (let i = 0; i < p.length; i += 3) {
      const d = (p[i]! - cx) ** 2 + (p[i + 1]! - cy) ** 2 + (p[i + 2]! - cz) ** 2;
      if (d > radius) radius = d;
    }
    this.camera.setBounds(centre, Math.sqrt(radius));
    this.camera.start();
  }

  private clear(): void {
    if (this.body) this.scene.remove(this.body);
    if (this.wires) this.scene.remove(this.wires);
    this.wires = null;
    this.body = null;
    for (const geometry of [this.base, this.edited, this.lines]) {
      geometry.dispose();
      for (const name of Object.keys(geometry.attributes)) geometry.deleteAttribute(name);
      geometry.setIndex(null);
    }
    this.coarse?.base.geometry.dispose();
    this.coarse?.edited.geometry.dispose();
    this.coarse = null;
    this.full = null;
    this.live = false;
    this.hasEdited = false;
    this.hasScalar = false;
    this.tinted = false;
    this.showFeatures([], 1);
    this.showRing(null, null);
    this.setLevels(0);
  }

  /** Normals of the shape as it was opened. */
  setNormals(normals: Int8Array): void {
    this.base.setAttribute('normal', new BufferAttribute(normals, 4, true));
    this.coarse?.base.take('normal', normals, 4, true);
    this.request();
  }

  setEdited(positions: Float32Array, normals: Int8Array): void {
    replace(this.edited, 'position', positions, 3, false);
    replace(this.edited, 'normal', normals, 4, true);
    for (const [name, attribute] of Object.entries(this.base.attributes)) {
      if (name !== 'position' && name !== 'normal') this.edited.setAttribute(name, attribute);
    }
    this.coarse?.edited.take('position', positions, 3, false);
    this.coarse?.edited.take('normal', normals, 4, true);
    this.hasEdited = true;
    this.live = false;
    this.request();
  }

  /** Forgets the edited shape: what is shown is the shape as it was opened. */
  setUnedited(): void {
    this.hasEdited = false;
    this.live = false;
    this.request();
  }

  setLevels(nLevels: number): void {
    const few = this.coarse ? [this.coarse.base.geometry] : [];
    for (const geometry of [this.base, this.edited, ...few]) {
      for (let j = 0; j < 64; j++) geometry.deleteAttribute(`band${j}`);
    }
    this.nLevels = nLevels;
    this.scales = [];
    this.bands = [];
    this.forgetSums();
  }

  private scales: number[] = [];
  private bands: Int16Array[] = [];

  private forgetSums(): void {
    this.sums = noSums();
    this.live = false;
    for (const [key, material] of this.materials) {
      if ((JSON.parse(key) as Variant).nLevels === 0) continue;
      material.dispose();
      this.materials.delete(key);
    }
  }

  setBand(level: number, scale: number, values: Int16Array): void {
    // What the shader sees is value / 32767.
    this.scales[level - 1] = scale * 32767;
    if (maskPacks(this.nLevels, 0) === null) return;
    this.bands[level - 1] = values;
    if (this.heavy) {
      // Only the few vertices that are drawn while it moves need them there.
      this.coarse?.base.take(`band${level - 1}`, values, 4, true);
      return;
    }
    if (!this.large) return;
    const attribute = new BufferAttribute(values, 4, true);
    this.base.setAttribute(`band${level - 1}`, attribute);
    // What is drawn is what is sent to the graphics: not only when a slider is moved first.
    if (this.hasEdited) this.edited.setAttribute(`band${level - 1}`, attribute);
    this.request();
  }

  setCoarse(triangles: Uint32Array): void {
    const base = new Compact(triangles, this.n);
    const edited = new Compact(triangles, this.n);
    for (const [name, attribute] of Object.entries(this.base.attributes)) {
      const { array, itemSize, normalized } = attribute as BufferAttribute;
      base.take(name, array, itemSize, normalized);
    }
    for (const [j, values] of this.bands.entries()) if (values) base.take(`band${j}`, values, 4, true);
    if (this.hasEdited) {
      for (const [name, attribute] of Object.entries(this.edited.attributes)) {
        const { array, itemSize, normalized } = attribute as BufferAttribute;
        edited.take(name, array, itemSize, normalized);
      }
    }
    this.coarse = { base, edited };
  }

  /** Whether moving sliders are summed by the shader; else the worker is fast enough, and its normals are smooth. */
  get large(): boolean {
    return (
      this.n > 0 &&
      this.nTriangles + (this.cloud ? this.n : 0) > (this.software ? LARGE.software : LARGE.hardware)
    );
  }

  /** Whether a moving shape needs fewer triangles. */
  get heavy(): boolean {
    return this.nTriangles > (this.software ? MOVING_LIMIT.software : MOVING_LIMIT.hardware);
  }

  /** Values of one layer's mask from vertex `from` on. */
  setMask(slot: number, from: number, bytes: Uint8Array): void {
    if (slot > 7) return;
    const name = `masks${slot >> 2}`;
    let attribute = this.base.getAttribute(name) as BufferAttribute | undefined;
    if (!attribute) {
      attribute = new BufferAttribute(new Uint8Array(4 * this.n), 4, true);
      this.base.setAttribute(name, attribute);
      if (this.hasEdited) this.edited.setAttribute(name, attribute);
    }
    const array = attribute.array as Uint8Array;
    for (let v = 0, k = 4 * from + (slot & 3); v < bytes.length; v++, k += 4) array[k] = bytes[v]!;
    attribute.addUpdateRange(4 * from, 4 * bytes.length);
    attribute.needsUpdate = true;
    for (const few of this.coarse ? [this.coarse.base, this.coarse.edited] : []) {
      if (few.geometry.hasAttribute(name)) few.takeRange(name, array, from, from + bytes.length);
      else few.take(name, array, 4, true);
    }
    this.request();
  }

  /** Tints what is in the mask of a slot; null: nothing. */
  setTint(slot: number | null): void {
    for (const tint of this.tints) tint.set(0, 0, 0, 0);
    if (slot !== null) this.tints[slot >> 2]?.setComponent(slot & 3, 1);
    this.tinted = slot !== null && slot < 8;
    this.request();
  }

  setScalar(values: Float32Array | null, range: [number, number] = [0, 1], map: MapName = 'viridis'): void {
    this.hasScalar = values !== null;
    if (values) {
      replace(this.base, 'scalar', values, 1, false);
      if (this.hasEdited) this.edited.setAttribute('scalar', this.base.getAttribute('scalar'));
      this.coarse?.base.take('scalar', values, 1, false);
      this.coarse?.edited.take('scalar', values, 1, false);
      (this.shared['range']!.value as Vector2).set(...range);
      this.texture.image.data!.set(table(map));
      this.texture.needsUpdate = true;
    }
    this.request();
  }

  setScalarRange(range: [number, number], map: MapName): void {
    (this.shared['range']!.value as Vector2).set(...range);
    this.texture.image.data!.set(table(map));
    this.texture.needsUpdate = true;
    this.request();
  }

  /**
   * The edit as uniforms: gains of the layers that act everywhere, and opacity · (gain − 1) of those with a mask, by slot.
   * False where the shader cannot do it.
   */
  setGains(
    global: ArrayLike<number>,
    masked: readonly { slot: number; slopes: readonly number[] }[],
  ): boolean {
    const nMasks = masked.reduce((n, m) => Math.max(n, m.slot + 1), 0);
    const packs = maskPacks(this.nLevels, nMasks);
    if (packs === null || (this.heavy && !this.coarse)) return false;
    const each = 4 * packs;
    if (this.sums.gains.value.length !== this.nLevels || packs !== this.packs) {
      this.forgetSums();
      this.packs = packs;
      this.sums.gains.value = new Array<number>(this.nLevels).fill(1);
      this.sums.scales.value = new Array<number>(this.nLevels).fill(0);
      this.sums.slopes.value = new Array<number>(Math.max(1, this.nLevels * each)).fill(0);
    }
    const { gains, scales, slopes } = this.sums;
    slopes.value.fill(0);
    for (let j = 0; j < this.nLevels; j++) {
      gains.value[j] = global[j]!;
      scales.value[j] = this.scales[j] ?? 0;
      for (const m of masked) slopes.value[j * each + m.slot] = m.slopes[j]!;
    }
    this.live = true;
    this.request();
    return true;
  }

  setEdges(pairs: Uint32Array): void {
    this.lines.setIndex(new BufferAttribute(pairs, 1));
    this.wires = new LineSegments(this.lines, lineMaterial(0.35, 0.0002));
    this.wires.frustumCulled = false;
    this.wires.renderOrder = 1;
    this.scene.add(this.wires);
    this.request();
  }

  get hasEdges(): boolean {
    return this.wires !== null;
  }

  showRing(outer: Float32Array | null, inner: Float32Array | null): void {
    for (const [i, segments] of [outer, inner].entries()) {
      const ring = this.ring[i]!;
      ring.visible = segments !== null && segments.length > 0;
      if (!segments || !ring.visible) continue;
      ring.geometry.dispose();
      ring.geometry = new BufferGeometry();
      ring.geometry.setAttribute('position', new BufferAttribute(segments, 3));
    }
    this.request();
  }

  showFeatures(features: readonly Feature[], radii: number): void {
    this.balls.visible = features.length > 0;
    this.balls.geometry.dispose();
    this.balls.geometry = new BufferGeometry();
    if (features.length === 0) return;
    const g = this.balls.geometry;
    g.setAttribute(
      'position',
      new BufferAttribute(Float32Array.from(features.flatMap((f) => f.position)), 3),
    );
    g.setAttribute(
      'size',
      new BufferAttribute(
        Float32Array.from(features, (f) => radii * f.sigma),
        1,
      ),
    );
    g.setAttribute(
      'sign',
      new BufferAttribute(
        Float32Array.from(features, (f) => f.sign),
        1,
      ),
    );
    this.request();
  }

  resize(width: number, height: number): void {
    this.renderer.setSize(width, height, false);
    this.camera.resize(width, height);
    this.request();
  }

  /** Something is being moved: for a moment fewer triangles will do. */
  touch(): void {
    window.clearTimeout(this.moving);
    this.moving = window.setTimeout(() => {
      this.moving = 0;
      if (this.heavy && this.coarse) this.request();
    }, REST);
    this.request();
  }

  request(): void {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.draw();
    });
  }

  /** Draws now. */
  draw(): void {
    const began = performance.now();
    const { renderer } = this;
    const coarse = this.coarse !== null && this.heavy && (this.moving !== 0 || this.live);
    if (this.software) {
      const ratio = coarse ? MOVING_RATIO : 1;
      if (renderer.getPixelRatio() !== ratio) renderer.setPixelRatio(ratio);
    }
    const width = renderer.domElement.width;
    const height = renderer.domElement.height;
    if (!this.body || width === 0) {
      renderer.clear();
      return;
    }
    const uniforms = this.shared;
    const perPixel = height / (2 * Math.tan((15 * Math.PI) / 180));
    uniforms['pointSize']!.value = this.pointSize * perPixel;
    this.balls.material.uniforms['pixels']!.value = perPixel;
    renderer.clear();
    if (this.split === null) {
      this.drawHalf(this.before, coarse);
    } else {
      const ratio = renderer.getPixelRatio();
      const x = Math.round((this.split * width) / ratio);
      renderer.setScissorTest(true);
      renderer.setScissor(0, 0, x, height / ratio);
      this.drawHalf(true, coarse);
      renderer.setScissor(x, 0, width / ratio - x, height / ratio);
      this.drawHalf(false, coarse);
      renderer.setScissorTest(false);
    }
    this.drawn?.(began);
  }

  private drawHalf(before: boolean, coarse: boolean): void {
    const body = this.body!;
    const live = !before && this.live && this.nLevels > 0;
    const edited = !before && !live && this.hasEdited;
    const few = coarse ? this.coarse : null;
    body.geometry = few ? (edited ? few.edited : few.base).geometry : edited ? this.edited : this.base;
    body.material = this.material({
      nLevels: live ? this.nLevels : 0,
      packs: live ? this.packs : 0,
      cloud: this.cloud,
      clay: this.style === 'matcap',
      // Normals of the shape as it was opened do not fit the live sum.
      flat: live || this.style === 'flat' || !body.geometry.hasAttribute('normal'),
      scalar: this.hasScalar,
      tint: this.tinted && !before && !this.hasScalar,
    });
    if (this.wires) {
      this.wires.visible = this.style === 'edges' && !live && !coarse;
      if (this.wires.visible) this.lines.setAttribute('position', body.geometry.getAttribute('position'));
      (this.wires.material.uniforms['ink']!.value as Vector4).set(
        ...rgb(COLOURS[this.theme].paper === 0x17181a ? 0 : 0x1b1d20),
        0.4,
      );
    }
    this.renderer.render(this.scene, this.camera.three);
  }

  /** Waits until all that was drawn is finished, by reading a pixel. */
  finish(): void {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  picture(): Promise<Blob> {
    this.draw();
    return new Promise((done, failed) => {
      this.canvas.toBlob(
        (blob) => (blob ? done(blob) : failed(new Error('The picture could not be made.'))),
        'image/png',
      );
    });
  }
}

function noSums(): Record<'gains' | 'scales' | 'slopes', { value: number[] }> {
  return { gains: { value: [] }, scales: { value: [] }, slopes: { value: [] } };
}

function rgb(colour: number): [number, number, number] {
  return [(colour >> 16) / 255, ((colour >> 8) & 255) / 255, (colour & 255) / 255];
}

function lineMaterial(opacity: number, bias: number): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: lineVertex,
    fragmentShader: lineFragment,
    uniforms: { ink: { value: new Vector4(0, 0, 0, opacity) }, bias: { value: bias } },
    transparent: true,
    depthWrite: false,
  });
}

/** Puts an array into an attribute: of the same size into the buffer that is there. */
function replace(
  geometry: BufferGeometry,
  name: string,
  array: Float32Array | Int8Array,
  itemSize: number,
  normalized: boolean,
): void {
  const attribute = geometry.getAttribute(name) as BufferAttribute | undefined;
  if (
    attribute &&
    attribute.array.length === array.length &&
    attribute.array.constructor === array.constructor
  ) {
    attribute.array = array as typeof attribute.array;
    attribute.needsUpdate = true;
  } else {
    geometry.setAttribute(name, new BufferAttribute(array, itemSize, normalized));
  }
}
