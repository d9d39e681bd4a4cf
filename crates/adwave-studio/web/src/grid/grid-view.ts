/** Picture of an image or a volume: its panes, the cross that links them, and the values under it. */

import { globalGains } from '../compute/positions';
import { h } from '../dom';
import { frameBar } from '../frames';
import type { GridInfo } from '../protocol';
import { soloLayers } from '../state';
import type { Shown, Studio } from '../studio';
import { text } from '../text';
import { type GridMemory, recallGrid } from './grid-memory';
import { Pane } from './pane';
import { type Part, Plane, partFor, queryOf } from './plane';
import { type ShadeMode, type Shading, usualHeight } from './shade';
import { gridWipe, type Wipe } from './wipe';

/** Largest number of values of a loaded part; with its bands they are some forty megabytes. */
const MOST_VALUES = 1 << 20;
/** Largest value of the types of numbers of pictures, which full opacity has. */
const FULL: Record<string, number> = { u8: 255, u16: 65535 };

/** Choices of how values are shown; part of the view. */
export interface GridLook {
  mode: ShadeMode;
  window: [number, number];
  /** Factor of the heights of a relief, relative to the usual one. */
  relief: number;
  smooth: boolean;
}

/** Values at a place: its index along each axis, and one number for each channel before and after the edit. */
export interface PlaceValues {
  at: number[];
  /** Frame of a series that the values are of; `null` without frames. */
  frame: number | null;
  before: number[];
  after: number[];
}

/** Frame of a series of images or volumes. */
interface FrameOfGrid {
  name: string;
  series: { name: string; step: number | null };
  /** Number of the frame, from 0. */
  frame: number;
}

interface PaneState {
  pane: Pane;
  loading: boolean;
  isWanted: boolean;
  /** Index of the loaded slice; the gains and colors that it is painted with are those of `painted`. */
  painted: string;
  /** Slice, part and look of the picture before the edit, for a wipe. */
  paintedBefore: string;
}

export class GridView implements Shown {
  readonly element = h('div', { class: 'grid-panes', hidden: true });
  look: GridLook = { mode: 'gray', window: [0, 1], relief: 1, smooth: false };
  /** Index along each axis of the place of the cross. */
  cross: number[] = [];
  /** Place under the pointer; `null` without one. */
  hovered: number[] | null = null;
  grid: GridInfo | null = null;
  private panes: PaneState[] = [];
  /** Frame of a series that the panes show, or will once it is loaded; 0 without frames. */
  private shownFrame = 0;
  private drawRequest = 0;
  private usualHeight = 1;
  private hasMark = false;
  private waiters: (() => void)[] = [];
  private shownDoc: unknown = null;
  /** Counter of contents; answers to requests for an older one are ignored. */
  private content = 0;
  private readonly listeners: (() => void)[] = [];
  readonly wipe: Wipe = gridWipe(() => this.request());
  /** Slider over the frames of a series. */
  readonly frames = frameBar<FrameOfGrid>(({ frame }) => this.showFrame(frame));

  constructor(private readonly studio: Studio) {
    new ResizeObserver(() => this.request()).observe(this.element);
    studio.on('before', () => this.request());
    studio.on('theme', () => this.request());
    studio.on('shape', () => {
      if (!studio.isGrid) this.frames.set([], 0);
    });
  }

  /** Calls `listener` when the cross, the place under the pointer or its values change. */
  onPlace(listener: () => void): void {
    this.listeners.push(listener);
  }

  private get id(): number {
    return this.studio.shape!.id;
  }

  /** Opens an image or a volume. */
  async open(grid: GridInfo): Promise<void> {
    this.grid = grid;
    this.cross = grid.sizes.map((n) => n >> 1);
    this.hovered = null;
    this.hasMark = grid.sizes.length === 3;
    this.look = usualLook(grid, this.studio.shape!.format);
    const isVolume = grid.sizes.length === 3;
    this.panes = grid.views.map((view, k) => {
      const pane = new Pane(grid, view, text.pane(view.name, isVolume), !isVolume, {
        point: (at, how) => this.point(k, at, how),
        leave: () => this.leave(),
        moved: () => this.request(),
        slice: (by) => this.step(view.fixed!, by),
      });
      pane.canvas.addEventListener('keydown', (event) => this.press(k, event));
      return { pane, loading: false, isWanted: false, painted: '', paintedBefore: '' };
    });
    const titled = ({ pane }: PaneState) =>
      isVolume ? h('figure', {}, pane.element, h('figcaption', {}, pane.view.name)) : pane.element;
    this.element.replaceChildren(...this.panes.map(titled), this.wipe.divider, this.frames.element);
    const memory = recallGrid(this.studio.shape!);
    if (memory) {
      this.look = { ...memory.look };
      this.cross = memory.cross.map((k, axis) => Math.min(grid.sizes[axis]! - 1, Math.max(0, Math.round(k))));
      for (const [k, { pane }] of this.panes.entries()) if (memory.panes[k]) pane.place = memory.panes[k];
    }
    this.element.classList.toggle('three', isVolume);
    this.openFrames(grid, memory?.frame ?? 0);
    this.reload();
    await this.waitUntilSettled();
    const plane = this.panes[0]?.pane.plane;
    if (!plane) return;
    const { step } = plane.part;
    const [perRow, perColumn] = this.spacingsOf(this.panes[0]!);
    this.usualHeight = usualHeight(
      { values: plane.values, rows: plane.rows, columns: plane.columns, nChannels: plane.nChannels },
      [perRow * step, perColumn * step],
    );
    if (this.look.mode === 'relief') this.repaint();
  }

  /** Offers the frames of a series, and begins with one of them. */
  private openFrames({ frames }: GridInfo, first: number): void {
    const n = frames?.n ?? 1;
    this.shownFrame = Math.min(n - 1, first);
    this.element.classList.toggle('series', n > 1);
    const { id, name } = this.studio.shape!;
    const series = { name, step: frames?.step ?? null };
    const list = Array.from({ length: n }, (_, frame) => ({ name: `${id} ${frame}`, series, frame }));
    this.frames.set(list, this.shownFrame);
  }

  /** Loads a frame in all panes; until it is there they show the one before. */
  private showFrame(frame: number): Promise<void> {
    this.shownFrame = frame;
    this.request();
    return this.waitUntilSettled();
  }

  /** Everything that is remembered from one visit to the next. */
  get memory(): GridMemory {
    const { look, cross, shownFrame } = this;
    return { look, cross, frame: shownFrame, panes: this.panes.map(({ pane }) => pane.place) };
  }

  /** Shows the values before the edit in a part of the panes, or no longer. */
  toggleWipe(): void {
    this.wipe.toggle();
    this.studio.emit('before');
  }

  /** Loads all planes again, because the bands are others. */
  reload(): void {
    this.content++;
    for (const state of this.panes) {
      state.pane.plane = null;
      state.painted = '';
      state.paintedBefore = '';
    }
    this.request();
  }

  /** Shows other choices of the look. */
  setLook(change: Partial<GridLook>): void {
    this.look = { ...this.look, ...change };
    this.repaint();
  }

  private repaint(): void {
    for (const state of this.panes) {
      state.painted = '';
      state.paintedBefore = '';
    }
    this.request();
  }

  /** Draws at once: the browser tells of a movement of a slider once for each frame, before it is shown. */
  show(): void {
    if (!this.grid) return;
    cancelAnimationFrame(this.drawRequest);
    this.drawRequest = 0;
    this.draw();
    this.release();
  }

  showTarget(): void {
    this.show();
  }

  settle(): void {
    this.request();
  }

  get isCurrent(): boolean {
    return this.shownDoc === this.studio.doc && !this.isBusy;
  }

  private get isBusy(): boolean {
    return this.drawRequest !== 0 || this.panes.some((state) => state.loading);
  }

  waitUntilSettled(): Promise<void> {
    if (!this.isBusy) return Promise.resolve();
    return new Promise((done) => this.waiters.push(done));
  }

  /** Draws once with the next frame of the browser. */
  request(): void {
    if (!this.grid || this.drawRequest !== 0) return;
    this.drawRequest = requestAnimationFrame(() => {
      this.drawRequest = 0;
      this.draw();
      this.release();
    });
  }

  private release(): void {
    if (!this.isBusy) for (const done of this.waiters.splice(0)) done();
  }

  private draw(): void {
    const { studio, grid } = this;
    if (!grid || !studio.isGrid || this.element.hidden) return;
    const began = performance.now();
    const gains = this.gains();
    const showsOriginal = studio.view.showsOriginal;
    const style = getComputedStyle(this.element);
    const [ink, muted] = ['--accent', '--strong'].map((name) => style.getPropertyValue(name));
    const hasGaps = grid.n_missing > 0;
    const frame = this.element.getBoundingClientRect();
    const split = this.wipe.at === null ? null : frame.left + this.wipe.at * frame.width;
    for (const state of this.panes) {
      const { pane } = state;
      this.load(state);
      const { plane } = pane;
      if (plane) {
        const painted = `${this.content} ${JSON.stringify(plane.part)} ${gains} ${showsOriginal}`;
        if (painted !== state.painted) {
          if (!showsOriginal) plane.edit(gains);
          pane.paint(this.shadingOf(state), showsOriginal);
          state.painted = painted;
        }
        const paintedBefore = `${this.content} ${JSON.stringify(plane.part)}`;
        if (split !== null && paintedBefore !== state.paintedBefore) {
          pane.paint(this.shadingOf(state), true, true);
          state.paintedBefore = paintedBefore;
        }
      }
      const cross = this.hasMark ? pane.view.axes.map((axis) => this.cross[axis]!) : null;
      const shown = cross as [number, number] | null;
      const wipe = split === null ? null : split - pane.canvas.getBoundingClientRect().left;
      pane.draw({ smooth: this.look.smooth, cross: shown, wipe, hasGaps, ink: ink!, muted: muted! });
    }
    this.shownDoc = studio.doc;
    studio.timings.recordFrame(began, true, () => this.finish());
    this.tell();
  }

  /** Waits until the panes are drawn. */
  private finish(): void {
    for (const { pane } of this.panes) pane.canvas.getContext('2d')!.getImageData(0, 0, 1, 1);
  }

  /** Gain of each band: that of all layers together, or of the band that is shown alone. */
  private gains(): Float64Array {
    const { studio } = this;
    const layers = soloLayers(studio.doc.layers, studio.solo).filter((layer) => layer.on);
    const terms = layers.map(({ opacity, gains }) => ({ opacity, gains, mask: null }));
    return globalGains(terms, studio.nLevels);
  }

  private spacingsOf({ pane }: PaneState): [number, number] {
    const [down, right] = pane.view.axes;
    return [this.grid!.height_spacings[down]!, this.grid!.height_spacings[right]!];
  }

  private shadingOf(state: PaneState): Shading {
    const { look, grid } = this;
    const nChannels = grid!.n_channels;
    const hasOpacity = nChannels === 4 && this.studio.shape!.format === 'png';
    return {
      mode: look.mode,
      window: look.window,
      spacings: this.spacingsOf(state),
      height: look.relief * this.usualHeight,
      opacity: hasOpacity ? { full: FULL[grid!.value_type] ?? 1 } : null,
    };
  }

  /** Loads the part of a pane that is seen, unless it is there; of requests made meanwhile the last one follows. */
  private load(state: PaneState): void {
    const { pane } = state;
    const index = pane.view.fixed === null ? 0 : this.cross[pane.view.fixed]!;
    const frame = this.grid!.frames ? this.shownFrame : null;
    const own = pane.plane?.part;
    const loaded = own?.index === index && own.frame === frame ? own : null;
    const most = Math.floor(MOST_VALUES / this.grid!.n_channels);
    const part = partFor(pane.sizes, pane.seen, most, loaded);
    if (!part) return;
    if (state.loading) {
      state.isWanted = true;
      return;
    }
    state.loading = true;
    void this.fetch(state, { ...part, index, frame }).finally(() => {
      state.loading = false;
      if (state.isWanted) {
        state.isWanted = false;
        this.request();
      } else this.release();
    });
  }

  private async fetch(state: PaneState, part: Part): Promise<void> {
    const { content, studio } = this;
    const nChannels = this.grid!.n_channels;
    try {
      const floats = await studio.api.floats(`shapes/${this.id}/plane?${queryOf(state.pane.view, part)}`);
      if (content !== this.content || !this.panes.includes(state)) return;
      state.pane.plane = new Plane(part, nChannels, floats);
      this.request();
    } catch (error) {
      if (content !== this.content) return;
      this.frames.stop();
      studio.showMessage((error as Error).message, 'error');
    }
  }

  private point(k: number, at: [number, number], how: 'press' | 'drag' | 'click' | 'hover'): void {
    const { pane } = this.panes[k]!;
    const [row, column] = [Math.round(at[0]), Math.round(at[1])];
    const isInside = row >= 0 && column >= 0 && row < pane.sizes[0] && column < pane.sizes[1];
    const clip = (x: number, n: number) => Math.min(n - 1, Math.max(0, x));
    const place = this.cross.slice();
    place[pane.view.axes[0]] = clip(row, pane.sizes[0]);
    place[pane.view.axes[1]] = clip(column, pane.sizes[1]);
    if (how === 'hover') {
      this.hovered = isInside ? place : null;
      this.tell();
      return;
    }
    if (!isInside && how !== 'drag') return;
    this.hovered = null;
    this.setCross(place);
  }

  private leave(): void {
    this.hovered = null;
    this.tell();
  }

  /** Moves the cross, and with it the slices of a volume. */
  setCross(place: readonly number[]): void {
    this.cross = place.map((k, axis) => Math.min(this.grid!.sizes[axis]! - 1, Math.max(0, k)));
    this.hasMark = true;
    this.request();
  }

  /** Moves the cross along an axis. */
  step(axis: number, by: number): void {
    this.setCross(this.cross.map((k, a) => (a === axis ? k + by : k)));
  }

  /** Moves the cross, or the plane of an image, by keys. */
  private press(k: number, event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { pane } = this.panes[k]!;
    const { axes, flips, fixed } = pane.view;
    const arrows: Record<string, [number, number]> = {
      ArrowUp: [0, -1],
      ArrowDown: [0, 1],
      ArrowLeft: [1, -1],
      ArrowRight: [1, 1],
    };
    const arrow = arrows[event.key];
    if (arrow && (fixed === null) !== event.shiftKey) {
      const by = -48 * arrow[1];
      pane.move(arrow[0] === 1 ? by : 0, arrow[0] === 0 ? by : 0);
    } else if (arrow) this.step(axes[arrow[0]]!, (flips[arrow[0]] ? -1 : 1) * arrow[1]);
    else if (event.key === '+' || event.key === '=') pane.enlarge(1.25);
    else if (event.key === '-') pane.enlarge(0.8);
    else if (event.key === 'PageUp' && fixed !== null) this.step(fixed, 1);
    else if (event.key === 'PageDown' && fixed !== null) this.step(fixed, -1);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  enlarge(factor: number): void {
    for (const { pane } of this.panes) pane.enlarge(factor);
  }

  fitAll(): void {
    for (const { pane } of this.panes) pane.fitAll();
  }

  /** Values at the place under the pointer, or at the cross; `null` while they are not loaded. */
  get place(): PlaceValues | null {
    const at = this.hovered ?? (this.hasMark ? this.cross : null);
    if (!at) return null;
    for (const { pane } of this.panes) {
      const { plane, view } = pane;
      if (!plane || (view.fixed !== null && plane.part.index !== at[view.fixed])) continue;
      const k = plane.at(at[view.axes[0]]!, at[view.axes[1]]!);
      if (k < 0) continue;
      const channels = (values: Float32Array) => [
        ...values.subarray(k * plane.nChannels, (k + 1) * plane.nChannels),
      ];
      const { frame } = plane.part;
      return { at, frame, before: channels(plane.values), after: channels(plane.edited) };
    }
    return null;
  }

  private tell(): void {
    const at = this.hovered ?? (this.hasMark ? this.cross : null);
    const found = this.panes.find(({ pane }) => {
      const { plane, view } = pane;
      return plane && at && (view.fixed === null || plane.part.index === at[view.fixed]);
    });
    const plane = found?.pane.plane;
    const axes = found?.pane.view.axes;
    const k = plane && axes && at ? plane.at(at[axes[0]]!, at[axes[1]]!) : -1;
    this.studio.showSpectrum(plane && k >= 0 ? plane.spectrumAt(k) : []);
    for (const listener of this.listeners) listener();
  }

  /** Values of the panes after the edit, for tests. */
  get editedPlanes(): Float32Array[] {
    return this.panes.map(({ pane }) => pane.plane?.edited ?? new Float32Array(0));
  }

  /** All panes as one picture, as they are on the screen; by default with so many pixels as these have. */
  async picture(wide: number | null = null, isTransparent = false): Promise<Blob> {
    const { width, height, left, top } = this.element.getBoundingClientRect();
    const ratio = wide === null ? window.devicePixelRatio || 1 : wide / width;
    const canvas = h('canvas', { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const context = canvas.getContext('2d')!;
    if (!isTransparent) {
      context.fillStyle = getComputedStyle(document.body).backgroundColor;
      context.fillRect(0, 0, canvas.width, canvas.height);
    }
    try {
      for (const { pane } of this.panes) pane.ratio = ratio;
      // A larger picture shows more places than the screen, which are loaded first.
      this.request();
      await this.waitUntilSettled();
      this.draw();
      for (const { pane } of this.panes) {
        const box = pane.canvas.getBoundingClientRect();
        context.drawImage(pane.canvas, (box.left - left) * ratio, (box.top - top) * ratio);
      }
    } finally {
      for (const { pane } of this.panes) pane.ratio = null;
      this.request();
    }
    return new Promise((done, fail) =>
      canvas.toBlob((blob) => (blob ? done(blob) : fail(new Error(text.noPicture)))),
    );
  }
}

/** Look of an image or a volume that is opened: that of its kind of file. */
function usualLook(grid: GridInfo, format: string | null): GridLook {
  const { least, greatest, low, high } = grid.range;
  const isPicture = grid.value_type === 'u8' && (format === 'png' || format === 'jpeg');
  const ends: [number, number] = isPicture ? [0, 255] : [low, high];
  const window: [number, number] =
    ends[1] > ends[0] ? ends : [least, greatest > least ? greatest : least + 1];
  const mode = grid.terrain ? 'relief' : grid.n_channels >= 3 ? 'color' : 'gray';
  return { mode, window, relief: 1, smooth: false };
}
