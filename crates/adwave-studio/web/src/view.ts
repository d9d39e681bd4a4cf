/**
 * The picture. The shape is drawn in one of three ways: as it was opened (`base`), after the edit with smooth normals as
 * the worker gave it (`edited`), or while something moves as base + bands summed by the shader (`live`).
 */

import {
  BufferAttribute,
  BufferGeometry,
  ColorManagement,
  Mesh,
  Points,
  RawShaderMaterial,
  Scene,
  WebGLRenderer,
} from 'three';
import { Camera } from './camera';
import type { MapName } from './colours';
import { Compact } from './compact';
import { boundingSphere, replace } from './geometry';
import { type Masked, Materials } from './materials';
import { Overlays } from './overlays';
import type { Feature } from './protocol';
import { maskPacks } from './shader';

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
  private readonly scene = new Scene();
  private readonly base = new BufferGeometry();
  private readonly edited = new BufferGeometry();
  /** Another shape of the same vertices, shown in place of the one that was opened. */
  private readonly other = new BufferGeometry();
  private hasOther = false;
  private readonly materials = new Materials();
  private readonly overlays: Overlays;
  private body: Mesh<BufferGeometry, RawShaderMaterial> | Points<BufferGeometry, RawShaderMaterial> | null =
    null;
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
    this.overlays = new Overlays(this.scene);
    this.setTheme('light');
  }

  setTheme(theme: Theme): void {
    const colours = COLOURS[theme];
    this.materials.setColours(rgb(colours.surface), rgb(colours.accent));
    this.renderer.setClearColor(colours.paper, 1);
    this.overlays.setInk(rgb(colours.ink), rgb(theme === 'dark' ? 0 : COLOURS.light.ink));
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
    this.other.setIndex(this.full);
    this.body = cloud
      ? new Points(this.base, new RawShaderMaterial())
      : new Mesh(this.base, new RawShaderMaterial());
    this.body.frustumCulled = false;
    this.scene.add(this.body);
    const { centre, radius } = boundingSphere(positions);
    this.camera.setBounds(centre, radius);
    this.camera.start();
    this.request();
  }

  private clear(): void {
    if (this.body) this.scene.remove(this.body);
    this.body = null;
    for (const geometry of [this.base, this.edited, this.other]) {
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
    this.hasOther = false;
    this.materials.hasScalar = false;
    this.materials.tinted = false;
    this.overlays.clear();
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
    this.shareAttributes(this.edited);
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
    this.materials.forgetSums();
    this.live = false;
  }

  private scales: number[] = [];
  private bands: Int16Array[] = [];

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
    this.materials.setTint(slot);
    this.request();
  }

  setScalar(values: Float32Array | null, range: [number, number] = [0, 1], map: MapName = 'viridis'): void {
    this.materials.hasScalar = values !== null;
    if (values) {
      replace(this.base, 'scalar', values, 1, false);
      if (this.hasEdited) this.edited.setAttribute('scalar', this.base.getAttribute('scalar'));
      this.coarse?.base.take('scalar', values, 1, false);
      this.coarse?.edited.take('scalar', values, 1, false);
      this.materials.setScalarRange(range, map);
    }
    this.request();
  }

  setScalarRange(range: [number, number], map: MapName): void {
    this.materials.setScalarRange(range, map);
    this.request();
  }

  /** The edit as a sum by the shader; false where it cannot do it. */
  setGains(global: ArrayLike<number>, masked: Masked): boolean {
    if (this.heavy && !this.coarse) return false;
    if (!this.materials.setSums(global, masked, this.scales, this.nLevels)) return false;
    this.live = true;
    this.request();
    return true;
  }

  /** Another shape of the same vertices in place of the one that was opened, or that one again. */
  setOther(positions: Float32Array | null, normals: Int8Array | null): void {
    this.hasOther = positions !== null;
    if (positions && normals) {
      replace(this.other, 'position', positions, 3, false);
      replace(this.other, 'normal', normals, 4, true);
      this.shareAttributes(this.other);
    }
    this.request();
  }

  /** What is not of a position is that of the shape as it was opened. */
  private shareAttributes(geometry: BufferGeometry): void {
    for (const [name, attribute] of Object.entries(this.base.attributes)) {
      if (name !== 'position' && name !== 'normal') geometry.setAttribute(name, attribute);
    }
  }

  setEdges(pairs: Uint32Array): void {
    this.overlays.setEdges(pairs);
    this.request();
  }

  get hasEdges(): boolean {
    return this.overlays.hasEdges;
  }

  showRing(outer: Float32Array | null, inner: Float32Array | null): void {
    this.overlays.showRing(outer, inner);
    this.request();
  }

  showFeatures(features: readonly Feature[], radii: number): void {
    this.overlays.showFeatures(features, radii);
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

  /** Draws now, in place of the frame that was asked for. */
  draw(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const began = performance.now();
    const { renderer } = this;
    const coarse = this.coarse !== null && this.heavy && (this.moving !== 0 || this.live);
    if (this.software) this.setRatio(coarse);
    const width = renderer.domElement.width;
    const height = renderer.domElement.height;
    if (!this.body || width === 0) {
      renderer.clear();
      return;
    }
    const perPixel = height / (2 * Math.tan((15 * Math.PI) / 180));
    this.materials.setPointSize(this.pointSize * perPixel);
    this.overlays.setPixels(perPixel);
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

  /**
   * Fewer pixels for what moves. Other pixels are a new canvas, which takes half as long as the picture: a single step keeps those
   * of the shape at rest, and a slider that is held keeps the few.
   */
  private setRatio(coarse: boolean): void {
    const now = this.renderer.getPixelRatio();
    const ratio = !coarse ? 1 : this.moving !== 0 ? MOVING_RATIO : now;
    if (now !== ratio) this.renderer.setPixelRatio(ratio);
  }

  private drawHalf(before: boolean, coarse: boolean): void {
    const body = this.body!;
    const { materials } = this;
    const other = before && this.hasOther;
    const live = !before && this.live && this.nLevels > 0;
    const edited = !before && !live && this.hasEdited;
    // The other shape has no coarse triangles of its own: it is drawn in full.
    const few = coarse && !other ? this.coarse : null;
    body.geometry = other
      ? this.other
      : few
        ? (edited ? few.edited : few.base).geometry
        : edited
          ? this.edited
          : this.base;
    body.material = materials.get({
      nLevels: live ? this.nLevels : 0,
      packs: live ? materials.packs : 0,
      cloud: this.cloud,
      clay: this.style === 'matcap',
      // Normals of the shape as it was opened do not fit the live sum.
      flat: live || this.style === 'flat' || !body.geometry.hasAttribute('normal'),
      scalar: materials.hasScalar,
      tint: materials.tinted && !before && !materials.hasScalar,
    });
    this.overlays.placeEdges(this.style === 'edges' && !live && !few, body.geometry);
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

function rgb(colour: number): [number, number, number] {
  return [(colour >> 16) / 255, ((colour >> 8) & 255) / 255, (colour & 255) / 255];
}
