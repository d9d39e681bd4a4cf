/** One pane of an image or a volume: draws a plane, and moves and enlarges it. */

import { h } from '../dom';
import type { GridInfo, SliceView } from '../protocol';
import type { PaneMemory } from './grid-memory';
import type { Plane } from './plane';
import { type Shading, shade } from './shade';

/** Largest number of pixels of the screen for one place, and least number for the whole plane. */
const MOST_PIXELS = 64;
/** Distance of the stripes where there are no data, in pixels of the page. */
const STRIPES = 12;
/** Pixels of a movement below which a press is a click. */
const CLICK = 4;

export interface PaneEvents {
  /** The pointer was pressed or moved on the place of these indices along the axes of the pane; `done` at its end. */
  point(at: [number, number], how: 'press' | 'drag' | 'click' | 'hover'): void;
  /** The pointer left the pane. */
  leave(): void;
  /** The part that is seen has changed. */
  moved(): void;
  /** The wheel asks for another slice. */
  slice(by: number): void;
}

export class Pane {
  readonly element: HTMLElement;
  readonly canvas: HTMLCanvasElement;
  /** Number of rows and columns of the whole plane. */
  readonly sizes: readonly [number, number];
  plane: Plane | null = null;
  /** Pixels for one of the page; `null` for those of the screen. */
  ratio: number | null = null;
  private readonly context: CanvasRenderingContext2D;
  private readonly picture = document.createElement('canvas');
  /** The plane before the edit, for a wipe. */
  private readonly before = document.createElement('canvas');
  /** Enlargement, 1 for a plane that fits; and the indices in the middle of the pane. */
  private zoom = 1;
  private middle: [number, number];
  private readonly pointers = new Map<number, [number, number]>();
  private readonly spacings: readonly [number, number];

  constructor(
    grid: GridInfo,
    readonly view: SliceView,
    label: string,
    /** True if dragging moves the plane, false if it moves the cross. */
    private readonly dragMoves: boolean,
    private readonly events: PaneEvents,
  ) {
    const [down, right] = view.axes;
    this.sizes = [grid.sizes[down]!, grid.sizes[right]!];
    this.spacings = [grid.spacings[down]!, grid.spacings[right]!];
    this.middle = [(this.sizes[0] - 1) / 2, (this.sizes[1] - 1) / 2];
    this.canvas = h('canvas', { tabIndex: 0, 'aria-label': label, role: 'img' });
    const [left, rightEdge, low, up] = view.edges;
    const edges = view.edges.every((name) => name)
      ? [
          h('span', { class: 'edge left' }, left),
          h('span', { class: 'edge right' }, rightEdge),
          h('span', { class: 'edge low' }, low),
          h('span', { class: 'edge up' }, up),
        ]
      : [];
    this.element = h('div', { class: 'pane' }, this.canvas, ...edges);
    this.context = this.canvas.getContext('2d', { willReadFrequently: true })!;
    this.listen();
  }

  /** Pixels of the page for a unit of length when the plane fits. */
  private get fit(): number {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const room = this.dragMoves ? 0.94 : 0.9;
    return (
      room * Math.min(width / (this.sizes[1] * this.spacings[1]), height / (this.sizes[0] * this.spacings[0]))
    );
  }

  /** Pixels of the page from one row, and from one column, to the next; negative if the index grows upward or to the left. */
  private get pitch(): [number, number] {
    const scale = this.fit * this.zoom;
    const [upward, leftward] = this.view.flips;
    return [(upward ? -1 : 1) * scale * this.spacings[0], (leftward ? -1 : 1) * scale * this.spacings[1]];
  }

  /** Place on the screen of indices, in pixels of the page from the corner of the pane. */
  toScreen([row, column]: readonly [number, number]): [number, number] {
    const [perRow, perColumn] = this.pitch;
    const { clientWidth, clientHeight } = this.canvas;
    return [
      clientWidth / 2 + (column - this.middle[1]) * perColumn,
      clientHeight / 2 + (row - this.middle[0]) * perRow,
    ];
  }

  /** Indices at a place of the screen, fractions included. */
  toIndices(x: number, y: number): [number, number] {
    const [perRow, perColumn] = this.pitch;
    const { clientWidth, clientHeight } = this.canvas;
    return [
      this.middle[0] + (y - clientHeight / 2) / perRow,
      this.middle[1] + (x - clientWidth / 2) / perColumn,
    ];
  }

  /** Indices that are seen, and the number of places for each pixel of the screen. */
  get seen(): { low: [number, number]; high: [number, number]; perPixel: number } {
    const a = this.toIndices(0, 0);
    const b = this.toIndices(this.canvas.clientWidth, this.canvas.clientHeight);
    const ratio = this.ratio ?? (window.devicePixelRatio || 1);
    return {
      low: [Math.min(a[0], b[0]), Math.min(a[1], b[1])],
      high: [Math.max(a[0], b[0]), Math.max(a[1], b[1])],
      perPixel: 1 / (ratio * Math.max(...this.pitch.map(Math.abs))),
    };
  }

  /** Enlarges about a place of the screen, by default the middle. */
  enlarge(factor: number, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2): void {
    const before = this.toIndices(x, y);
    const most = MOST_PIXELS / (this.fit * Math.min(...this.spacings));
    this.zoom = Math.min(Math.max(1, most), Math.max(0.5, this.zoom * factor));
    const after = this.toIndices(x, y);
    this.middle = [this.middle[0] + before[0] - after[0], this.middle[1] + before[1] - after[1]];
    this.keepInside();
    this.events.moved();
  }

  /** Moves the plane by pixels of the page. */
  move(dx: number, dy: number): void {
    const [perRow, perColumn] = this.pitch;
    this.middle = [this.middle[0] - dy / perRow, this.middle[1] - dx / perColumn];
    this.keepInside();
    this.events.moved();
  }

  /** Shows the whole plane. */
  fitAll(): void {
    this.zoom = 1;
    this.middle = [(this.sizes[0] - 1) / 2, (this.sizes[1] - 1) / 2];
    this.events.moved();
  }

  private keepInside(): void {
    const inside = (x: number, n: number) => Math.min(n - 1, Math.max(0, x));
    this.middle = [inside(this.middle[0], this.sizes[0]), inside(this.middle[1], this.sizes[1])];
  }

  /** Enlargement and middle, to be restored at another visit. */
  get place(): PaneMemory {
    return { zoom: this.zoom, middle: [...this.middle] };
  }

  set place({ zoom, middle }: PaneMemory) {
    this.zoom = Math.max(0.5, zoom);
    this.middle = [...middle];
    this.keepInside();
  }

  /** Computes the colors of the plane: of the values that are shown, or of those before the edit for a wipe. */
  paint(shading: Shading, showsOriginal: boolean, isForWipe = false): void {
    const { plane } = this;
    const picture = isForWipe ? this.before : this.picture;
    if (!plane) return;
    const { rows, columns, nChannels } = plane;
    if (picture.width !== columns || picture.height !== rows) {
      picture.width = columns;
      picture.height = rows;
    }
    const image = new ImageData(columns, rows);
    const values = showsOriginal ? plane.values : plane.edited;
    const [perRow, perColumn] = shading.spacings;
    const { step } = plane.part;
    shade(
      { values, rows, columns, nChannels },
      { ...shading, spacings: [perRow * step, perColumn * step] },
      image.data,
    );
    picture.getContext('2d', { willReadFrequently: true })!.putImageData(image, 0, 0);
  }

  /** Draws the plane and the cross at these indices. */
  draw(options: {
    smooth: boolean;
    cross: readonly [number, number] | null;
    /** Place in pixels of the page up to which the plane is shown as it was before the edit; `null` for none of it. */
    wipe: number | null;
    /** True if there are places without data, which are shown as stripes. */
    hasGaps: boolean;
    ink: string;
    muted: string;
  }): void {
    const { canvas, context, plane, picture } = this;
    const ratio = this.ratio ?? (window.devicePixelRatio || 1);
    const [width, height] = [
      Math.max(1, Math.round(canvas.clientWidth * ratio)),
      Math.max(1, Math.round(canvas.clientHeight * ratio)),
    ];
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    if (plane) {
      const { from, step } = plane.part;
      const [perRow, perColumn] = this.pitch;
      // The first place covers half a spacing before its index.
      const [x, y] = this.toScreen([from[0] - 0.5, from[1] - 0.5]);
      if (options.hasGaps) this.drawStripes(ratio, options.muted);
      context.setTransform(ratio * perColumn * step, 0, 0, ratio * perRow * step, ratio * x, ratio * y);
      context.imageSmoothingEnabled = options.smooth;
      context.imageSmoothingQuality = 'high';
      context.drawImage(picture, 0, 0);
      if (options.wipe !== null && options.wipe > 0) this.drawBefore(options.wipe * ratio);
    }
    if (options.cross) this.drawCross(options.cross, ratio, options.ink);
  }

  /** Draws the plane before the edit up to a column of the canvas, with the present transform. */
  private drawBefore(width: number): void {
    const { context, before } = this;
    const transform = context.getTransform();
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.beginPath();
    context.rect(0, 0, width, this.canvas.height);
    context.clip();
    context.clearRect(0, 0, width, this.canvas.height);
    context.setTransform(transform);
    context.drawImage(before, 0, 0);
    context.restore();
  }

  private drawStripes(ratio: number, ink: string): void {
    const { context, sizes } = this;
    const a = this.toScreen([-0.5, -0.5]);
    const b = this.toScreen([sizes[0] - 0.5, sizes[1] - 0.5]);
    const [left, top] = [Math.min(a[0], b[0]), Math.min(a[1], b[1])];
    const [width, height] = [Math.abs(a[0] - b[0]), Math.abs(a[1] - b[1])];
    context.save();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.beginPath();
    context.rect(left, top, width, height);
    context.clip();
    context.beginPath();
    const { clientWidth, clientHeight } = this.canvas;
    for (let x = -clientHeight; x < clientWidth; x += STRIPES) {
      context.moveTo(x, 0);
      context.lineTo(x + clientHeight, clientHeight);
    }
    context.strokeStyle = ink;
    context.lineWidth = 1;
    context.stroke();
    context.restore();
  }

  private drawCross(at: readonly [number, number], ratio: number, ink: string): void {
    const { context, canvas } = this;
    const [x, y] = this.toScreen(at);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.strokeStyle = ink;
    context.lineWidth = 1;
    const gap = this.dragMoves ? 4 : 6;
    const reach = this.dragMoves ? 12 : Math.max(canvas.clientWidth, canvas.clientHeight);
    context.beginPath();
    for (const [dx, dy] of [
      [1, 0],
      [-1, 0],
      [0, 1],
      [0, -1],
    ] as const) {
      context.moveTo(x + gap * dx, y + gap * dy);
      context.lineTo(x + reach * dx, y + reach * dy);
    }
    context.stroke();
  }

  private listen(): void {
    const { canvas, pointers, events } = this;
    const placeOf = (event: PointerEvent | WheelEvent): [number, number] => {
      const { left, top } = canvas.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    let moves = false;
    let travelled = 0;
    canvas.addEventListener('pointerdown', (event) => {
      if (event.button > 2) return;
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, placeOf(event));
      if (pointers.size === 1) travelled = 0;
      moves = this.dragMoves || event.button !== 0 || event.shiftKey || pointers.size > 1;
      if (!moves) events.point(this.toIndices(...placeOf(event)), 'press');
    });
    canvas.addEventListener('pointermove', (event) => {
      const [x, y] = placeOf(event);
      const before = pointers.get(event.pointerId);
      if (!before) {
        events.point(this.toIndices(x, y), 'hover');
        return;
      }
      travelled += Math.abs(x - before[0]) + Math.abs(y - before[1]);
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)![1];
        const distance = ([a, b]: [number, number]) => Math.hypot(a - other[0], b - other[1]) || 1;
        this.enlarge(distance([x, y]) / distance(before), (x + other[0]) / 2, (y + other[1]) / 2);
        this.move((x - before[0]) / 2, (y - before[1]) / 2);
      } else if (moves) this.move(x - before[0], y - before[1]);
      else events.point(this.toIndices(x, y), 'drag');
      pointers.set(event.pointerId, [x, y]);
    });
    const end = (event: PointerEvent) => {
      if (!pointers.delete(event.pointerId) || pointers.size > 0) return;
      if (moves && travelled < CLICK && event.type === 'pointerup')
        events.point(this.toIndices(...placeOf(event)), 'click');
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
    canvas.addEventListener('pointerleave', () => events.leave());
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('dblclick', () => this.fitAll());
    canvas.addEventListener(
      'wheel',
      (event) => {
        event.preventDefault();
        if (this.dragMoves || event.ctrlKey) {
          this.enlarge(Math.exp(-event.deltaY / 400), ...placeOf(event));
        } else events.slice(event.deltaY > 0 ? -1 : 1);
      },
      { passive: false },
    );
  }
}
