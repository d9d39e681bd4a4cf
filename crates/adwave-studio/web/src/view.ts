/**
 * Renderer: schedules frames and chooses resolution, triangles and the split of the picture. The shape is drawn in one of
 * three ways: the original, the edited positions with smooth normals from the worker, or, during motion, the sum of bands
 * in the shader.
 */

import {
  type BufferGeometry,
  Color,
  ColorManagement,
  Mesh,
  Points,
  RawShaderMaterial,
  Scene,
  WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import { ShapeArrays } from './arrays';
import { type BesideArrays, BesideShape } from './beside-shape';
import { Camera } from './camera';
import { type Clip, clipEquation, isClipped } from './clip';
import type { MapName } from './colors';
import type { Bent } from './compute/messages';
import { EyeDome } from './eye-dome';
import { boundsOf } from './geometry';
import { type Masked, Materials } from './materials';
import { Overlays } from './overlays';
import type { Feature } from './protocol';
import type { LitSide } from './shader';

/** Part of a larger picture, in samples. */
export interface PicturePart {
  /** Camera of the whole picture. */
  camera: Camera;
  whole: { width: number; height: number };
  part: { x: number; y: number; width: number; height: number };
  /** Samples around the part that are drawn too, for points whose centers lie there. */
  margin: number;
  /** Samples for a pixel of the page. */
  scale: number;
  /** Color of the ground, from 0 to 1; `null` leaves it transparent. */
  ground: [number, number, number] | null;
}

export type Style = 'shaded' | 'matcap' | 'flat' | 'edges';
export type Theme = 'light' | 'dark';

const COLORS: Record<Theme, { surface: number; accent: number; paper: number; ink: number }> = {
  light: { surface: 0xd9d7d2, accent: 0x0a62ba, paper: 0xf4f4f2, ink: 0x1b1d20 },
  dark: { surface: 0xbdbbb6, accent: 0x4aa3ff, paper: 0x17181a, ink: 0xf2f2f0 },
};

// Colors are sRGB values as in the style sheet; the shaders write them unchanged.
ColorManagement.enabled = false;

/** Pixel ratios of the picture without a GPU: while a large shape moves, while a small one does, and at rest. */
const RATIOS = { large: 0.6, small: 1, rest: 2 };
/** Milliseconds after the last movement until all triangles are drawn again, and from then until a large shape gets smooth edges. */
const REST = 160;
const REST_OF_LARGE = 1500;

export class View {
  readonly camera = new Camera();
  readonly renderer: WebGLRenderer;
  readonly rendererName: string;
  readonly arrays: ShapeArrays;
  style: Style = 'shaded';
  lit: LitSide = 'front';
  /** Shows the original shape. */
  showsOriginal = false;
  /** Position of the divider between before and after, relative to the width; `null` without a split. */
  split: number | null = null;
  /** Called after each frame. */
  onDrawn: ((began: number) => void) | null = null;
  private readonly frameListeners: (() => void)[] = [];
  private readonly moveListeners: (() => void)[] = [];
  private readonly software: boolean;
  private readonly scene = new Scene();
  private readonly besideScene = new Scene();
  private readonly materials = new Materials();
  private readonly overlays: Overlays;
  private readonly eyeDome = new EyeDome();
  /** Plane that cuts the shape; `null` if it is whole. */
  clip: Clip | null = null;
  private bounds = { low: [0, 0, 0], high: [0, 0, 0] };
  private body: Mesh<BufferGeometry, RawShaderMaterial> | Points<BufferGeometry, RawShaderMaterial> | null =
    null;
  /** A shape of another tab, drawn in the second half of the picture. */
  private beside: BesideShape | null = null;
  private size = { width: 1, height: 1 };
  private pointSize = 1;
  /** True for a graph or a curve, whose edges are always drawn. */
  private isGraph = false;
  /** Factor on the size of the points of a cloud. */
  pointScale = 1;
  private frame = 0;
  private moving = 0;
  private smoothing = 0;
  /** Camera by which the shape is drawn. */
  private lens = this.camera.three;
  /** Color of the ground of the page, from 0 to 1. */
  paper: [number, number, number] = [1, 1, 1];
  /** True once the picture may take its time. */
  private isAtRest = false;

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
    // 2 × 2 supersampling smooths the edges and needs less memory than multisampling. Without a GPU every pixel costs
    // time, and the picture is supersampled at rest only.
    this.renderer.setPixelRatio(this.software ? RATIOS.small : Math.max(2, Math.min(3, devicePixelRatio)));
    this.renderer.autoClear = false;
    this.renderer.outputColorSpace = 'srgb-linear';
    this.arrays = new ShapeArrays(this.software, () => this.request());
    this.overlays = new Overlays(this.scene);
    this.setTheme('light');
  }

  setTheme(theme: Theme): void {
    const colors = COLORS[theme];
    this.materials.setColors(rgb(colors.surface), rgb(colors.accent));
    this.renderer.setClearColor(colors.paper, 1);
    this.paper = rgb(colors.paper);
    this.overlays.setInk(rgb(colors.ink), rgb(theme === 'dark' ? 0 : COLORS.light.ink));
    this.request();
  }

  /** Sets a new shape; positions are relative to its center. Without triangles it is a cloud, or a graph with edges. */
  setShape(
    positions: Float32Array,
    triangles: Uint32Array,
    graph: { edges: Uint32Array; isFlat: boolean } | null,
    meanLength: number,
  ): void {
    this.clear();
    const cloud = triangles.length === 0;
    this.isGraph = graph !== null;
    if (graph) this.overlays.setEdges(graph.edges, 'below');
    this.pointSize = meanLength * 1.4;
    const geometry = this.arrays.setShape(positions, triangles, cloud);
    const material = new RawShaderMaterial();
    this.body = cloud ? new Points(geometry, material) : new Mesh(geometry, material);
    this.body.frustumCulled = false;
    this.scene.add(this.body);
    const { low, high, center, radius } = boundsOf(positions);
    this.bounds = { low, high };
    this.camera.setBounds(center, radius, meanLength);
    this.camera.isFlat = graph?.isFlat ?? false;
    this.camera.outline = positions;
    this.setClip(null);
    this.camera.start();
    this.request();
  }

  /** Shows another shape in the second half of the picture; `null` gives all of it to the present one. */
  setBeside(arrays: BesideArrays | null): void {
    this.beside?.dispose();
    this.besideScene.clear();
    this.beside = null;
    if (arrays) {
      const isHeavy = this.arrays.isHeavy(arrays.triangles.length / 3);
      this.beside = new BesideShape(arrays, new RawShaderMaterial(), isHeavy);
      this.besideScene.add(this.beside.body);
    }
    this.camera.setCompany(this.beside?.bounds ?? null);
    this.resize(this.size.width, this.size.height);
    this.camera.frame();
  }

  /** Colors the shape in the second half by one number per vertex, with the range and colors of the first. */
  setBesideScalar(values: Float32Array | null): void {
    this.beside?.setScalar(values);
    this.request();
  }

  /** Way in which the picture is divided: not at all, or into halves beside or below each other. */
  get halves(): 'one' | 'beside' | 'below' {
    if (!this.beside) return 'one';
    return this.size.width >= this.size.height ? 'beside' : 'below';
  }

  /** Size of the part of the picture that shows a shape, in pixels of the page. */
  get part(): { width: number; height: number } {
    const { width, height } = this.size;
    if (this.halves === 'one') return { width, height };
    return this.halves === 'beside' ? { width: width / 2, height } : { width, height: height / 2 };
  }

  /** Place in its half of a point of the picture, and whether that is the second one. */
  placeInHalf({ x, y }: { x: number; y: number }): { x: number; y: number; isSecond: boolean } {
    const { width, height } = this.part;
    if (this.halves === 'beside' && x > width) return { x: x - width, y, isSecond: true };
    if (this.halves === 'below' && y > height) return { x, y: y - height, isSecond: true };
    return { x, y, isSecond: false };
  }

  private clear(): void {
    if (this.body) this.scene.remove(this.body);
    this.body = null;
    this.arrays.clear();
    this.materials.hasScalar = false;
    this.materials.hasRgb = false;
    this.materials.tinted = false;
    this.materials.forgetSums();
    this.overlays.clear();
  }

  /** True if the depth of the picture is shown by darker outlines. */
  private get isEyeDome(): boolean {
    return this.arrays.cloud && !this.isGraph;
  }

  setLevels(nLevels: number): void {
    this.arrays.setLevels(nLevels);
    this.materials.forgetSums();
  }

  /** Tints the mask of a slot; `null` turns the tint off. */
  setTint(slot: number | null): void {
    this.materials.setTint(slot);
    this.request();
  }

  /** Shows the colors of the file, `u8 × 4 × n`; `null` shows that of the surface. */
  setRgb(colors: Uint8Array | null): void {
    this.materials.hasRgb = colors !== null;
    this.materials.hasScalar = false;
    if (colors) this.arrays.setRgb(colors);
    this.request();
  }

  /** Colors the shape by one number per vertex; `unedited` are the numbers that the original has, if they differ. */
  setScalar(
    values: Float32Array | null,
    range: [number, number] = [0, 1],
    map: MapName = 'viridis',
    unedited: Float32Array | null = null,
  ): void {
    this.materials.hasScalar = values !== null;
    this.materials.hasRgb = false;
    this.arrays.setUneditedScalar(values && unedited);
    if (values) {
      this.arrays.setScalar(values);
      this.materials.setScalarRange(range, map);
    }
    this.request();
  }

  /** Replaces the numbers that color the edited shape. */
  updateScalar(values: Float32Array): void {
    this.arrays.setScalar(values);
    this.request();
  }

  setScalarRange(range: [number, number], map: MapName): void {
    this.materials.setScalarRange(range, map);
    this.request();
  }

  /** Shows the edit as a sum in the shader; returns false if the shader cannot sum it. */
  setGains(global: ArrayLike<number>, masked: Masked): boolean {
    const { arrays } = this;
    if (arrays.heavy && !arrays.hasFew) return false;
    if (!this.materials.setSums(global, masked, arrays.scales, arrays.nLevels, arrays.isPosed)) return false;
    arrays.live = 'sum';
    this.request();
    return true;
  }

  /** Shows the shape that is pulled, where the shader cannot sum its bands. Returns false if that is not possible either. */
  showPulled(bent: Bent): boolean {
    const shown = this.arrays.showPulled(bent);
    if (shown) this.request();
    return shown;
  }

  /** Cuts the shape; `null` shows it whole. Picking leaves out what is cut away. */
  setClip(clip: Clip | null): void {
    this.clip = clip;
    const equation = clip && clipEquation(clip, this.bounds);
    this.camera.clip = equation;
    this.materials.setClip(equation);
    this.overlays.setClip(equation);
    this.request();
  }

  /** Coordinate of a plane along its axis, relative to the center of the shape. */
  clipPlace(clip: Clip): number {
    return -clipEquation({ ...clip, flipped: false }, this.bounds)[3];
  }

  /** True if a place is cut away. */
  hides(place: readonly number[]): boolean {
    return this.camera.clip !== null && isClipped(this.camera.clip, place);
  }

  setEdges(pairs: Uint32Array): void {
    this.overlays.setEdges(pairs, 'above');
    this.request();
  }

  get hasEdges(): boolean {
    return this.overlays.hasEdges;
  }

  showRing(outer: Float32Array | null, inner: Float32Array | null): void {
    this.overlays.showRing(outer, inner);
    this.request();
  }

  /** Shows pins and handles as balls: positions, and for each 1 for a handle and −1 for a pin. */
  showHandles(places: readonly number[], signs: readonly number[]): void {
    this.overlays.showHandles(places, signs);
    this.request();
  }

  /** Marks the place of a click; `null` removes the mark. */
  showMark(place: readonly number[] | null): void {
    this.overlays.showMark(place);
    this.request();
  }

  showFeatures(features: readonly Feature[], radii: number): void {
    this.overlays.showFeatures(features, radii);
    this.request();
  }

  resize(width: number, height: number): void {
    this.size = { width, height };
    this.renderer.setSize(width, height, false);
    this.camera.resize(this.part.width, this.part.height);
    this.request();
  }

  /** Marks a movement: for a moment the coarse version is drawn. */
  markMoving(): void {
    for (const listener of this.moveListeners.splice(0)) listener();
    window.clearTimeout(this.moving);
    window.clearTimeout(this.smoothing);
    this.isAtRest = false;
    this.moving = window.setTimeout(() => {
      this.moving = 0;
      if (this.arrays.hasFew) this.request();
      if (this.software) this.smoothing = window.setTimeout(smooth, this.arrays.hasFew ? REST_OF_LARGE : 0);
    }, REST);
    const smooth = () => {
      this.isAtRest = true;
      this.request();
    };
    this.request();
  }

  request(): void {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.draw();
    });
  }

  /** Calls a listener after each frame, for what is drawn over the picture. */
  afterFrame(listener: () => void): void {
    this.frameListeners.push(listener);
  }

  /** Calls a listener when the picture moves the next time. */
  afterNextMove(listener: () => void): void {
    this.moveListeners.push(listener);
  }

  /** Draws now instead of in the requested frame. */
  draw(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const began = performance.now();
    const { renderer } = this;
    const coarse = this.arrays.hasFew && (this.moving !== 0 || this.arrays.live !== null);
    if (this.software) this.setRatio(coarse);
    const width = renderer.domElement.width;
    const height = renderer.domElement.height;
    if (!this.body || width === 0) {
      renderer.clear();
      return;
    }
    renderer.clear();
    const ratio = renderer.getPixelRatio();
    const part = this.halves === 'one' ? { width: width / ratio, height: height / ratio } : this.part;
    const perPixel = (part.height * ratio) / (2 * Math.tan((15 * Math.PI) / 180));
    this.materials.setPointSize(this.pointScale * this.pointSize * perPixel);
    this.overlays.setPixels(perPixel, ratio);
    // The lower left corner of the first half; rows are counted from below.
    const bottom = this.halves === 'below' ? part.height : 0;
    if (this.beside) renderer.setViewport(0, bottom, part.width, part.height);
    const drawWhole = () => this.drawShape(this.showsOriginal, coarse);
    if (this.split === null && !this.beside) {
      if (this.isEyeDome && (this.isAtRest || !this.software))
        this.eyeDome.light(renderer, this.camera.three, drawWhole);
      else drawWhole();
    } else {
      renderer.setScissorTest(true);
      if (this.split === null) {
        renderer.setScissor(0, bottom, part.width, part.height);
        this.drawShape(this.showsOriginal, coarse);
      } else {
        const x = Math.round(this.split * part.width);
        renderer.setScissor(0, bottom, x, part.height);
        this.drawShape(true, coarse);
        renderer.setScissor(x, bottom, part.width - x, part.height);
        this.drawShape(false, coarse);
      }
      if (this.beside) this.drawBeside(this.beside, part, perPixel);
      renderer.setScissorTest(false);
    }
    this.onDrawn?.(began);
    for (const listener of this.frameListeners) listener();
  }

  /**
   * Reduces the resolution during motion. Changing it allocates a new canvas, which takes half as long as drawing: a single
   * step keeps the full resolution, and a slider that is held keeps the reduced one.
   */
  private setRatio(coarse: boolean): void {
    const now = this.renderer.getPixelRatio();
    const still = coarse ? now : this.isAtRest ? RATIOS.rest : RATIOS.small;
    const ratio = this.moving === 0 ? still : coarse ? RATIOS.large : RATIOS.small;
    if (now !== ratio) this.renderer.setPixelRatio(ratio);
  }

  private drawBeside(beside: BesideShape, part: { width: number; height: number }, perPixel: number): void {
    const { renderer, materials } = this;
    const [x, y] = this.halves === 'beside' ? [part.width, 0] : [0, 0];
    renderer.setViewport(x, y, part.width, part.height);
    renderer.setScissor(x, y, part.width, part.height);
    materials.setPointSize(this.pointScale * beside.pointSize * perPixel);
    beside.choose(this.moving !== 0);
    beside.body.material = materials.get({
      nLevels: 0,
      packs: 0,
      posed: false,
      cloud: beside.isCloud,
      clay: this.style === 'matcap',
      lit: beside.lit,
      flat: this.style === 'flat',
      scalar: beside.hasScalar,
      classes: false,
      original: false,
      rgb: false,
      tint: false,
      clip: this.clip !== null,
    });
    renderer.render(this.besideScene, this.camera.three);
    renderer.setViewport(0, 0, this.size.width, this.size.height);
  }

  private drawShape(before: boolean, coarse: boolean): void {
    const body = this.body!;
    const { materials, arrays } = this;
    const { geometry, summed, few } = arrays.selectGeometry(before, coarse);
    body.geometry = geometry;
    body.material = materials.get({
      nLevels: summed ? arrays.nLevels : 0,
      packs: summed ? materials.packs : 0,
      posed: summed && arrays.isPosed,
      cloud: arrays.cloud,
      clay: this.style === 'matcap',
      lit: this.lit,
      // The normals of the original do not fit the sum; while a handle is pulled, those of the edit turn with it.
      flat: (summed && !arrays.hasPulledNormals) || this.style === 'flat' || !geometry.hasAttribute('normal'),
      scalar: materials.hasScalar,
      classes: materials.hasScalar && materials.hasClasses,
      original: materials.hasScalar && before && arrays.hasUneditedScalar,
      rgb: materials.hasRgb,
      tint: materials.tinted && !before,
      clip: this.clip !== null,
    });
    this.overlays.placeEdges((this.isGraph || this.style === 'edges') && !summed && !few, geometry);
    this.renderer.render(this.scene, this.lens);
  }

  /** Draws a part of a larger picture: `u8 × 4` each sample, rows from below, colors multiplied by their opacity. */
  drawSamples({ camera, whole, part, margin, scale, ground }: PicturePart): Uint8Array<ArrayBuffer> {
    const { renderer } = this;
    const [width, height] = [part.width + 2 * margin, part.height + 2 * margin];
    const target = new WebGLRenderTarget(width, height);
    const lens = camera.three;
    lens.setViewOffset(whole.width, whole.height, part.x - margin, part.y - margin, width, height);
    const perPixel = whole.height / (2 * Math.tan((lens.fov * Math.PI) / 360));
    this.materials.setPointSize(
      this.pointScale * this.pointSize * perPixel,
      scale / renderer.getPixelRatio(),
    );
    this.overlays.setPixels(perPixel, scale);
    const samples = new Uint8Array(4 * part.width * part.height);
    try {
      this.lens = lens;
      renderer.setClearColor(new Color().setRGB(...(ground ?? [0, 0, 0])), ground ? 1 : 0);
      renderer.setRenderTarget(target);
      renderer.clear();
      const draw = () => this.drawShape(this.showsOriginal, false);
      if (this.isEyeDome) this.eyeDome.light(renderer, lens, draw, target, scale);
      else draw();
      renderer.readRenderTargetPixels(target, margin, margin, part.width, part.height, samples);
    } finally {
      renderer.setRenderTarget(null);
      renderer.setClearColor(new Color().setRGB(...this.paper), 1);
      lens.clearViewOffset();
      this.lens = this.camera.three;
      target.dispose();
      this.request();
    }
    return samples;
  }

  /** Waits until drawing has finished, by reading a pixel. */
  finish(): void {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }
}

function rgb(color: number): [number, number, number] {
  return [(color >> 16) / 255, ((color >> 8) & 255) / 255, (color & 255) / 255];
}
