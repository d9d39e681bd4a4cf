/** Grab and pin: handles that bend the shape, and their panel. */

import { brush } from './brush';
import type { Hit } from './compute/pick';
import { h, segments } from './dom';
import type { Pose, PoseHandle, Region } from './protocol';
import { type Doc, isOn, reshapedBy } from './state';
import type { Studio } from './studio';
import { text } from './text';

export type GrabMode = 'pull' | 'pin' | 'unpin';
export type StrokeMode = 'pin' | 'unpin' | 'clone';

/** Action of the pointer, set by the panel. */
export const grab: { mode: GrabMode } = { mode: 'pull' };

/** Distance of the pointer from a handle, in pixels, within which it is taken. */
const NEAR = 16;
/** Distance of stamps of cloned detail, in radii. */
const CLONE_SPACING = 0.4;
/** Radius of the pin that a first pull sets at the far end, in percent of the diagonal. */
const FIRST_PIN = 8;

const EMPTY: Pose = { handle: [] };

/** Vertex of a handle of a single vertex; `null` for other handles. */
export function vertexOf({ region }: PoseHandle): number | null {
  return 'vertices' in region && region.vertices.indices.length === 1 ? region.vertices.indices[0]! : null;
}

/** Regions that are pinned. */
export function pinsOf(pose: Pose): readonly Region[] {
  const { fixed } = pose;
  if (!fixed) return [];
  return 'any' in fixed ? fixed.any : [fixed];
}

/** The pose with other pins. */
export function withPins(pose: Pose, pins: readonly Region[]): Pose {
  return { ...pose, fixed: pins.length > 0 ? { any: [...pins] } : null };
}

/** Pins without the vertices for which `isNear` is true. */
export function withoutPins(pins: readonly Region[], isNear: (vertex: number) => boolean): Region[] {
  const left: Region[] = [];
  for (const pin of pins) {
    if (!('vertices' in pin)) {
      left.push(pin);
      continue;
    }
    const indices = pin.vertices.indices.filter((v) => !isNear(v));
    if (indices.length === pin.vertices.indices.length) left.push(pin);
    else if (indices.length > 0) left.push({ vertices: { ...pin.vertices, indices } });
  }
  return left;
}

/** The pose with a handle moved. */
export function withMotion(pose: Pose, handle: number, by: readonly number[]): Pose {
  return { ...pose, handle: pose.handle.map((one, k) => (k === handle ? { ...one, by: [...by] } : one)) };
}

/** Vertex that is farthest from a place. */
export function farthestVertex(positions: ArrayLike<number>, place: readonly number[]): number {
  let best = 0;
  let most = -1;
  for (let i = 0; i < positions.length; i += 3) {
    const d =
      (positions[i]! - place[0]!) ** 2 +
      (positions[i + 1]! - place[1]!) ** 2 +
      (positions[i + 2]! - place[2]!) ** 2;
    if (d > most) {
      most = d;
      best = i / 3;
    }
  }
  return best;
}

/** A handle that is pulled. */
interface Pull {
  handle: number;
  /** Place of the handle when the pull began, and its motion. */
  start: readonly number[];
  by: readonly number[];
  /** Place under the pointer when the pull began. */
  from: readonly number[];
}

export class Grab {
  private pull: Pull | null = null;
  /** Vertices that a stroke has pinned, released or given detail. */
  private stroke: { mode: StrokeMode; before: Doc; vertices: number[] } | null = null;

  constructor(private readonly studio: Studio) {
    studio.on(['doc', 'moved', 'tool', 'shape', 'drawing'], () => this.showHandles());
  }

  private get pose(): Pose {
    return this.studio.doc.pose ?? EMPTY;
  }

  get isBusy(): boolean {
    return this.pull !== null || this.stroke !== null;
  }

  /** Handle under the pointer; −1 if there is none. */
  handleAt(x: number, y: number): number {
    const { camera, arrays } = this.studio.view;
    let best = -1;
    let nearest = NEAR;
    for (const [k, handle] of this.pose.handle.entries()) {
      const vertex = isOn(handle) ? vertexOf(handle) : null;
      if (vertex === null) continue;
      const at = camera.project(arrays.place(vertex));
      const d = Math.hypot(at.x - x, at.y - y);
      if (d < nearest) [best, nearest] = [k, d];
    }
    return best;
  }

  /** Begins to pull a handle, or a new one at a hit of the surface, from the point (x, y) of the canvas. */
  async begin(handle: number, hit: Hit | null, x: number, y: number): Promise<boolean> {
    const { studio } = this;
    const { camera, arrays } = studio.view;
    let pose = this.pose;
    if (handle < 0) {
      if (!hit) return false;
      const { by } = await studio.engine.call('shift', { vertex: hit.vertex });
      const region: Region = { vertices: { indices: [hit.vertex], radius: 0 } };
      if (!pose.fixed && pose.handle.length === 0) {
        pose = withPins(pose, [this.farPin(hit)]);
        studio.showMessage(text.pinnedFarEnd);
      }
      pose = { ...pose, handle: [...pose.handle, { by, region }] };
      handle = pose.handle.length - 1;
    }
    const vertex = vertexOf(pose.handle[handle]!);
    if (vertex === null) return false;
    const start = arrays.place(vertex);
    const pull = { handle, start, by: pose.handle[handle]!.by, from: camera.pointInPlane(start, x, y) };
    this.pull = pull;
    studio.isPulling = true;
    studio.view.arrays.startPull();
    try {
      // Binds the shape, and finds out if it can be.
      const by = reshapedBy({ clones: studio.doc.clones, pose }) ?? { clones: [], pose };
      const work = () => studio.engine.call('bend', { by, follow: 'step', drawn: true });
      const bound = await studio.wait(text.binding, work);
      // The pull may have been cancelled meanwhile, or followed by another one.
      if (this.pull !== pull) return false;
      if (bound === null) this.pull = null;
    } catch (error) {
      studio.showMessage((error as Error).message, 'error');
      if (this.pull === pull) this.pull = null;
    }
    if (!this.pull) {
      studio.isPulling = false;
      return false;
    }
    studio.history.preview({ ...studio.doc, pose });
    return true;
  }

  private farPin(hit: Hit): Region {
    const { shape, view } = this.studio;
    const vertex = farthestVertex(view.arrays.originals, hit.point);
    return { vertices: { indices: [vertex], radius: (FIRST_PIN / 100) * shape!.diagonal } };
  }

  /** Moves the pulled handle to the point (x, y) of the canvas. */
  moveTo(x: number, y: number): void {
    const { pull, studio } = this;
    if (!pull) return;
    const to = studio.view.camera.pointInPlane(pull.start, x, y);
    const by = pull.by.map((c, i) => c + to[i]! - pull.from[i]!);
    studio.view.camera.setReach(Math.hypot(...by) + Math.hypot(...pull.by));
    studio.history.preview({ ...studio.doc, pose: withMotion(this.pose, pull.handle, by) });
  }

  /** Ends the pull or the stroke, as one step or without any. */
  end(how: 'keep' | 'drop'): void {
    const { studio } = this;
    if (!this.isBusy) return;
    this.pull = null;
    this.stroke = null;
    studio.isPulling = false;
    if (how === 'keep') studio.history.end();
    else studio.history.cancel();
    studio.display.settle();
  }

  /** Begins to pin spots, to release them, or to clone detail to them. */
  beginStroke(mode: StrokeMode): void {
    this.studio.isPulling = mode === 'clone';
    this.stroke = { mode, before: this.studio.doc, vertices: [] };
  }

  /** Pins or releases the spot around a vertex, or clones detail to it. */
  touch(vertex: number): void {
    const { stroke, studio } = this;
    if (!stroke || stroke.vertices.includes(vertex)) return;
    stroke.vertices.push(vertex);
    const radius = (brush.radius / 100) * studio.shape!.diagonal;
    if (stroke.mode === 'clone') {
      const { cloneSource: source } = studio;
      const last = stroke.vertices.at(-2);
      // Stamps closer together would only cost time.
      if (source === null || (last !== undefined && this.distance(last, vertex) < CLONE_SPACING * radius)) {
        stroke.vertices.pop();
        return;
      }
      const targets = [...stroke.vertices];
      // The server leaves out the usual strength, and the stored edit is compared with this one after a reload.
      const strength = brush.strength === 1 ? {} : { strength: brush.strength };
      const clone = { source, targets, radius, ...strength };
      studio.history.preview({ ...studio.doc, clones: [...stroke.before.clones, clone] });
      return;
    }
    const pins = pinsOf(stroke.before.pose ?? EMPTY);
    const next =
      stroke.mode === 'pin'
        ? [...pins, { vertices: { indices: [...stroke.vertices], radius } }]
        : withoutPins(pins, (v) => stroke.vertices.some((other) => this.distance(v, other) <= radius));
    studio.history.preview({ ...studio.doc, pose: withPins(this.pose, next) });
  }

  private distance(a: number, b: number): number {
    const p = this.studio.view.arrays.originals;
    return Math.hypot(p[3 * a]! - p[3 * b]!, p[3 * a + 1]! - p[3 * b + 1]!, p[3 * a + 2]! - p[3 * b + 2]!);
  }

  /** Shows pins and handles while the tool is on. */
  private showHandles(): void {
    const { studio, pull } = this;
    const { arrays } = studio.view;
    const places: number[] = [];
    const signs: number[] = [];
    if (studio.isGrabOn && studio.shape) {
      for (const pin of this.pose.pinned === false ? [] : pinsOf(this.pose)) {
        const centers =
          'vertices' in pin
            ? pin.vertices.indices
            : 'ball' in pin && 'vertex' in pin.ball.center
              ? [pin.ball.center.vertex]
              : [];
        for (const v of centers) {
          places.push(...arrays.place(v));
          signs.push(-1);
        }
      }
      for (const [k, handle] of this.pose.handle.entries()) {
        const vertex = isOn(handle) ? vertexOf(handle) : null;
        if (vertex === null) continue;
        const moved = pull?.handle === k ? handle.by.map((c, i) => c - pull.by[i]!) : [0, 0, 0];
        const at = pull?.handle === k ? pull.start : arrays.place(vertex);
        places.push(...at.map((c, i) => c + moved[i]!));
        signs.push(1);
      }
    }
    studio.view.showHandles(places, signs);
  }
}

/** Pins the region of the selected layer. */
function pinRegion(studio: Studio): void {
  const { region } = studio.layer;
  if (!region) {
    studio.showMessage(text.pinNothing);
    return;
  }
  const pose = studio.doc.pose ?? EMPTY;
  studio.history.commit({ ...studio.doc, pose: withPins(pose, [...pinsOf(pose), region]) });
}

export function grabPanel(studio: Studio): HTMLElement {
  const mode = segments(text.grabMode, text.grabModes, grab.mode, (chosen) => {
    grab.mode = chosen;
    mode.set(chosen);
    hint.textContent = text.grabHints[chosen];
  });
  const hint = h('p', { class: 'hint' }, text.grabHints[grab.mode]);
  const count = h('p', { class: 'hint', role: 'status' });
  const setPose = (pose: Pose | null) => studio.history.commit({ ...studio.doc, pose });
  const last = h(
    'button',
    {
      type: 'button',
      onclick: () => {
        const { pose } = studio.doc;
        if (pose) setPose({ ...pose, handle: pose.handle.slice(0, -1) });
      },
    },
    text.removeHandle,
  );
  const straighten = h('button', { type: 'button', onclick: () => setPose(null) }, text.straighten);
  const region = h('button', { type: 'button', onclick: () => pinRegion(studio) }, text.pinRegion);
  const show = () => {
    const { pose } = studio.doc;
    count.textContent = text.grabCount(pose?.handle.length ?? 0, pose ? pinsOf(pose).length : 0);
    last.disabled = !pose || pose.handle.length === 0;
    straighten.disabled = pose === null;
  };
  studio.on(['doc', 'shape'], show);
  return h(
    'div',
    { class: 'grab-panel', role: 'group', 'aria-label': text.grab },
    mode,
    hint,
    count,
    h('div', { class: 'row' }, region, last, straighten),
  );
}
