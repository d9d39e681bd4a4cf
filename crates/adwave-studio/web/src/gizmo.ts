/** Handles in the picture that move and resize the region of the selected layer: a ball, a box or a half-space. */

import { h } from './dom';
import {
  addScaled,
  type BoxRegion,
  boxEdges,
  dot,
  type HalfSpaceRegion,
  movedBox,
  normalized,
  planeQuad,
  resizedBox,
  snapToAxis,
} from './gizmo-shapes';
import { toModelUnits } from './lengths';
import type { Region } from './protocol';
import type { Stage } from './stage';
import type { Studio } from './studio';
import { text } from './text';

type Point = { x: number; y: number };
/** Lengths to the right and up in the picture; a handle with a direction takes their sum. */
type Step = [number, number];

/** A handle: where it is, and the region that a drag or a key leads to. */
interface Handle {
  label: string;
  /** Place relative to the center of the shape. */
  place: number[];
  /** Direction along which it moves; a handle whose direction points at the viewer cannot be dragged. */
  axis: number[] | null;
  /** Region with the handle at a place of the picture. */
  drag: (at: Point, from: Point) => Region | Promise<Region | null> | null;
  /** Region after a step in the picture, to the right and up, in model units. */
  step: (by: Step) => Region | null;
}

/** Drawing of a region: polygons of places, of which a closed one returns to its start, and handles. */
interface Outline {
  lines: number[][][];
  /** Circle about a place, with a radius in model units. */
  circle: { place: number[]; radius: number } | null;
  handles: Handle[];
}

/** Least length on the screen, relative to that of a direction across, of a direction that can be dragged along. */
const LEAST_SLOPE = 0.12;
/** Size of the drawn part of a plane, and length of its arrow, relative to the diagonal. */
const PLANE = { half: 0.32, arrow: 0.22 };
/** Step of an arrow key, relative to the diagonal. */
const KEY_STEP = 0.01;
/** Signs of the step of each arrow key. */
const ARROWS: Record<string, Step> = {
  ArrowRight: [1, 0],
  ArrowLeft: [-1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};
/** Turn of a plane by an arrow key, in steps of the tip of its arrow. */
const TURN_STEPS = 4;
/** Number of doublings of a step that ends at the vertex where it began. */
const DOUBLINGS = 4;
/** Range of the radius of a ball, relative to the diagonal. */
const RADIUS = { least: 0.005, most: 0.6 };

export class Gizmo {
  readonly element: HTMLElement;
  private readonly path: SVGPathElement;
  private readonly halo: SVGPathElement;
  private buttons: HTMLButtonElement[] = [];
  private outline: Outline | null = null;
  /** Region that the outline belongs to. */
  private shown: Region | null = null;
  private isMasking = false;
  private maskAgain = false;
  private dragged: Handle | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly stage: Stage,
  ) {
    const space = 'http://www.w3.org/2000/svg';
    const svg = document.createElementNS(space, 'svg');
    this.halo = document.createElementNS(space, 'path');
    this.path = document.createElementNS(space, 'path');
    this.halo.setAttribute('class', 'halo');
    svg.append(this.halo, this.path);
    svg.setAttribute('aria-hidden', 'true');
    this.element = h('div', { class: 'gizmo', hidden: true });
    this.element.append(svg);
    studio.on(['doc', 'selected', 'tool', 'shape', 'target', 'drawing', 'tint'], () => this.update());
    studio.view.afterFrame(() => this.place());
  }

  /** Region of the selected layer without its inversions; `null` if it has no handles. */
  private get region(): Region | null {
    const { studio } = this;
    if (!studio.shape || studio.isBrushOn || studio.isGrabOn || !studio.tint.region) return null;
    let { region } = studio.layer;
    while (region && 'not' in region) region = region.not;
    return region && ('ball' in region || 'box' in region || 'half-space' in region) ? region : null;
  }

  /** Sets the region, as part of a drag; inversions stay. */
  private set(region: Region): void {
    const { studio } = this;
    const wrap = (outer: Region | null): Region =>
      outer && 'not' in outer ? { not: wrap(outer.not) } : region;
    studio.changeLayer({ region: wrap(studio.layer.region) }, false);
    // The shader of a large shape shows the mask that it has until the shape is at rest.
    if (studio.view.arrays.large) void this.showMask();
  }

  private async showMask(): Promise<void> {
    if (this.isMasking) {
      this.maskAgain = true;
      return;
    }
    this.isMasking = true;
    try {
      await this.studio.showMask(this.studio.layer, null);
    } catch (error) {
      this.studio.showMessage((error as Error).message, 'error');
    }
    this.isMasking = false;
    if (!this.maskAgain) return;
    this.maskAgain = false;
    void this.showMask();
  }

  private update(): void {
    const { region } = this;
    if (region === this.shown && region !== null) return;
    this.shown = region;
    this.outline = region && this.outlineOf(region);
    const handles = this.outline?.handles ?? [];
    if (handles.length !== this.buttons.length) {
      for (const button of this.buttons) button.remove();
      this.buttons = handles.map((_, i) => this.handleButton(i));
      this.element.append(...this.buttons);
    }
    for (const [i, { label }] of handles.entries()) {
      this.buttons[i]!.setAttribute('aria-label', label);
      this.buttons[i]!.title = label;
    }
    this.element.hidden = handles.length === 0;
    this.place();
  }

  /** Places the handles and lines for the present camera. */
  private place(): void {
    const { outline, studio } = this;
    if (!outline) return;
    // The radius of a ball is drawn across the direction of view.
    if (this.shown && 'ball' in this.shown) this.outline = this.outlineOf(this.shown);
    const { lines, circle, handles } = this.outline!;
    const { camera } = studio.view;
    const all = [...lines.flat(), ...handles.map((handle) => handle.place)];
    const isSeen = all.every((p) => camera.project(p).scale > 0);
    this.element.classList.toggle('behind', !isSeen);
    if (!isSeen) return;
    const parts = lines.map((line) => {
      const points = line.map((p) => {
        const { x, y } = camera.project(p);
        return `${x.toFixed(1)} ${y.toFixed(1)}`;
      });
      return `M${points.join('L')}`;
    });
    if (circle) {
      const { x, y, scale } = camera.project(circle.place);
      const r = circle.radius * scale;
      parts.push(`M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`);
    }
    for (const path of [this.halo, this.path]) path.setAttribute('d', parts.join(''));
    for (const [i, handle] of handles.entries()) {
      const { x, y } = camera.project(handle.place);
      const button = this.buttons[i]!;
      button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      const isSteep = handle.axis !== null && this.slope(handle.place, handle.axis).length < LEAST_SLOPE;
      button.classList.toggle('steep', isSteep && this.dragged === null);
    }
  }

  /** Direction of an axis on the screen, in pixels per model unit, and its length relative to one across. */
  private slope(place: number[], axis: number[]): { x: number; y: number; length: number } {
    const { camera } = this.studio.view;
    const unit = 1e-3 * this.studio.shape!.diagonal;
    const a = camera.project(place);
    const b = camera.project(addScaled(place, axis, unit));
    const [x, y] = [(b.x - a.x) / unit, (b.y - a.y) / unit];
    return { x, y, length: Math.hypot(x, y) / a.scale };
  }

  /** Distance along an axis to which the pointer has moved a handle, in model units. */
  private along(place: number[], axis: number[], from: Point, at: Point): number {
    const { x, y } = this.slope(place, axis);
    return ((at.x - from.x) * x + (at.y - from.y) * y) / Math.max(1e-12, x * x + y * y);
  }

  private outlineOf(region: Region): Outline | null {
    if ('box' in region) return this.boxOutline(region.box);
    if ('half-space' in region) return this.planeOutline(region['half-space']);
    return 'ball' in region ? this.ballOutline(region) : null;
  }

  private relative(point: readonly number[]): number[] {
    return point.map((x, c) => x - this.studio.shape!.center[c]!);
  }

  private boxOutline(box: BoxRegion): Outline {
    const { camera } = this.studio.view;
    const [low, high] = [this.relative(box.min), this.relative(box.max)];
    const middle = low.map((x, c) => (x + high[c]!) / 2);
    const faces = [0, 1, 2].flatMap((c) =>
      (['min', 'max'] as const).map((end): Handle => {
        const place = middle.with(c, end === 'min' ? low[c]! : high[c]!);
        const axis = [0, 0, 0].with(c, 1);
        const moved = (by: number): Region => ({ box: resizedBox(box, end, c, by) });
        return {
          label: `${end === 'min' ? text.from : text.to} ${'xyz'[c]}`,
          place,
          axis,
          drag: (at, from) => moved(this.along(place, axis, from, at)),
          step: ([x, y]) => moved(x + y),
        };
      }),
    );
    const center: Handle = {
      label: text.moveRegion,
      place: middle,
      axis: null,
      drag: (at, from) => {
        const [a, b] = [from, at].map(({ x, y }) => camera.pointInPlane(middle, x, y));
        return {
          box: movedBox(
            box,
            b!.map((x, c) => x - a![c]!),
          ),
        };
      },
      step: (by) => ({ box: movedBox(box, this.across(by)) }),
    };
    return { lines: boxEdges(low, high), circle: null, handles: [center, ...faces] };
  }

  /** Vector of a step across the direction of view. */
  private across([x, y]: Step): number[] {
    const { camera } = this.studio.view;
    return addScaled(addScaled([0, 0, 0], camera.right(), x), camera.upward(), y);
  }

  private planeOutline(half: HalfSpaceRegion): Outline {
    const { diagonal, center } = this.studio.shape!;
    const { camera } = this.studio.view;
    const normal = normalized(half.normal);
    // The part of the plane that is nearest to the center of the shape is drawn.
    const place = addScaled([0, 0, 0], normal, dot(this.relative(half.point), normal));
    const tip = addScaled(place, normal, PLANE.arrow * diagonal);
    const moved = (by: number): Region => ({
      'half-space': { ...half, point: addScaled(half.point, normal, by) },
    });
    const turned = (direction: number[]): Region | null => {
      if (!(Math.hypot(...direction) > 0.02 * diagonal)) return null;
      const point = place.map((x, c) => x + center[c]!);
      return { 'half-space': { ...half, point, normal: snapToAxis(normalized(direction)) } };
    };
    const handles: Handle[] = [
      {
        label: text.movePlane,
        place,
        axis: normal,
        drag: (at, from) => moved(this.along(place, normal, from, at)),
        step: ([x, y]) => moved(x + y),
      },
      {
        label: text.turnPlane,
        place: tip,
        axis: null,
        drag: ({ x, y }) => turned(camera.pointInPlane(tip, x, y).map((v, c) => v - place[c]!)),
        step: (by) => {
          const arrow = tip.map((v, c) => v - place[c]!);
          return turned(addScaled(arrow, this.across(by), TURN_STEPS));
        },
      },
    ];
    return { lines: [planeQuad(place, normal, PLANE.half * diagonal), [place, tip]], circle: null, handles };
  }

  private ballOutline(region: Extract<Region, { ball: unknown }>): Outline {
    const { ball } = region;
    const { view, shape } = this.studio;
    const { diagonal } = shape!;
    const place =
      'vertex' in ball.center ? view.arrays.place(ball.center.vertex) : this.relative(ball.center.point);
    const radius = toModelUnits(ball.radius, diagonal);
    const sized = (r: number): Region => {
      const next = Math.min(RADIUS.most * diagonal, Math.max(RADIUS.least * diagonal, r));
      return { ball: { ...ball, radius: Number(next.toPrecision(6)) } };
    };
    const handles: Handle[] = [
      {
        label: text.moveCenterHandle,
        place,
        axis: null,
        drag: async ({ x, y }) => {
          const vertex = await this.stage.vertexAt(x, y);
          return vertex === null ? null : { ball: { ...ball, center: { vertex } } };
        },
        step: (by) => {
          const vertex = this.vertexBeside(place, by);
          return vertex === null ? null : { ball: { ...ball, center: { vertex } } };
        },
      },
      {
        label: text.radius,
        place: addScaled(place, view.camera.right(), radius),
        axis: null,
        drag: ({ x, y }) =>
          sized(Math.hypot(...view.camera.pointInPlane(place, x, y).map((v, c) => v - place[c]!))),
        step: ([x, y]) => sized(radius + x + y),
      },
    ];
    return { lines: [], circle: { place, radius }, handles };
  }

  /** Vertex nearest to a place after a step, which grows while the vertex stays the same; `null` if there is no other. */
  private vertexBeside(place: number[], by: Step): number | null {
    const { arrays } = this.studio.view;
    const start = arrays.nearest(place);
    for (let k = 0; k <= DOUBLINGS; k++) {
      const vertex = arrays.nearest(addScaled(place, this.across(by), 2 ** k));
      if (vertex !== start) return vertex;
    }
    return null;
  }

  private handleButton(index: number): HTMLButtonElement {
    const button = h('button', { type: 'button', class: 'gizmo-handle' });
    const { studio } = this;
    const point = (e: PointerEvent): Point => {
      const r = studio.view.canvas.getBoundingClientRect();
      return { x: e.clientX - r.left, y: e.clientY - r.top };
    };
    let from: Point | null = null;
    let next: Point | null = null;
    let isBusy = false;
    const follow = async (handle: Handle, start: Point) => {
      if (isBusy) return;
      isBusy = true;
      try {
        while (next) {
          const at = next;
          next = null;
          const region = await handle.drag(at, start);
          // The drag was cancelled, or another layer was selected meanwhile.
          if (region && this.dragged === handle) this.set(region);
        }
      } catch (error) {
        studio.showMessage((error as Error).message, 'error');
      } finally {
        isBusy = false;
      }
    };
    button.addEventListener('pointerdown', (e) => {
      const handle = this.outline?.handles[index];
      if (!handle || e.button !== 0) return;
      e.preventDefault();
      button.focus({ preventScroll: true });
      button.setPointerCapture(e.pointerId);
      this.dragged = handle;
      from = point(e);
      button.classList.add('held');
    });
    button.addEventListener('pointermove', (e) => {
      if (!from || !this.dragged) return;
      next = point(e);
      void follow(this.dragged, from);
    });
    const end = async (e: PointerEvent) => {
      const handle = this.dragged;
      if (!from || !handle) return;
      from = null;
      button.classList.remove('held');
      while (isBusy) await new Promise((done) => setTimeout(done));
      if (this.dragged !== handle) return;
      this.dragged = null;
      if (e.type === 'pointerup') studio.history.end();
      else studio.history.cancel();
      this.place();
    };
    button.addEventListener('pointerup', (e) => void end(e));
    button.addEventListener('pointercancel', (e) => void end(e));
    button.addEventListener('keydown', (e) => {
      if (e.key === 'Escape' && this.dragged) {
        e.stopPropagation();
        this.dragged = null;
        from = null;
        button.classList.remove('held');
        studio.history.cancel();
        return;
      }
      const signs = ARROWS[e.key];
      if (!signs) return;
      const length = KEY_STEP * studio.shape!.diagonal;
      const region = this.outline?.handles[index]?.step([length * signs[0], length * signs[1]]);
      if (!region) return;
      e.preventDefault();
      e.stopPropagation();
      this.set(region);
      studio.history.end();
    });
    return button;
  }
}
