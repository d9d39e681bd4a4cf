/** Pointer input on the picture: camera, brush and picking. */

import { appendStroke, brush, brushShape, halfRadius, lastStamps, SPACING, smoothingRadius } from './brush';
import type { BrushShape, PickAnswer } from './compute/messages';
import type { Hit, Ray } from './compute/pick';
import { flatRing } from './compute/ring';
import { effectGains, effectOf } from './effects';
import { Grab, type GrabMode, grab, type StrokeMode } from './grab';
import type { Studio } from './studio';
import { text } from './text';

interface Stroke {
  pointer: number;
  key: number;
  shape: BrushShape;
  /** Position of the last stamp on the canvas. */
  x: number;
  y: number;
  /** Distance of stamps on the canvas, in pixels. */
  spacing: number;
  rays: Ray[];
  busy: boolean;
  ended: 'keep' | 'drop' | null;
  stamped: number;
}

/** A press that pulls, pins or clones. It lasts until the pointer is released and the shape is bound. */
interface Grabbing {
  pointer: number;
  handle: number;
  /** Surface under the press; `null` until it is known. */
  hit: Hit | null;
  /** True once the shape follows the pointer. */
  began: boolean;
  /** Last place of the pointer on the canvas, and how far it has moved. */
  at: { x: number; y: number };
  moved: number;
  released: boolean;
}

/** Milliseconds after zooming until the shape is looked for, by rays on a grid of this many rows and columns. */
const LOOK = 500;
const LOOK_GRID = 9;
/** Largest pointer movement of a click, in pixels. */
const CLICK = 4;

export class Stage {
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private stroke: Stroke | null = null;
  private hovering = false;
  private hoverNext: { x: number; y: number } | null = null;
  private turning: 'turn' | 'pan' | null = null;
  private moved = 0;
  private looking = 0;
  private pinch = { distance: 0, angle: 0, x: 0, y: 0 };
  /** Result of the last pick under the cursor. */
  private hoverAnswer: PickAnswer | null = null;
  private pendingPress: { id: number; x: number; y: number; invert: boolean; pressure: number } | null = null;
  private grabbing: Grabbing | null = null;
  private readonly grab: Grab;
  onClick: ((answer: PickAnswer, x: number, y: number) => void) | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly canvas: HTMLCanvasElement,
  ) {
    this.grab = new Grab(studio);
    canvas.addEventListener('pointerdown', (e) => this.onPointerDown(e));
    canvas.addEventListener('pointermove', (e) => this.onPointerMove(e));
    canvas.addEventListener('pointerup', (e) => this.onPointerUp(e));
    canvas.addEventListener('pointercancel', (e) => this.onPointerUp(e));
    canvas.addEventListener('pointerleave', () => this.onPointerLeave());
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener('dblclick', (e) => void this.setPivot(e));
    canvas.addEventListener('wheel', (e) => this.onWheel(e), { passive: false });
    studio.on('tool', () => {
      if (!studio.isBrushOn && !studio.isGrabOn) studio.view.showRing(null, null);
      canvas.classList.toggle('brushing', studio.isBrushOn);
      canvas.classList.toggle('grabbing', studio.isGrabOn);
    });
  }

  private canvasPoint(e: MouseEvent): { x: number; y: number } {
    const r = this.canvas.getBoundingClientRect();
    return { x: e.clientX - r.left, y: e.clientY - r.top };
  }

  private onPointerDown(e: PointerEvent): void {
    if (!this.studio.shape) return;
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(e.pointerId);
    const place = this.canvasPoint(e);
    this.pointers.set(e.pointerId, place);
    this.moved = 0;
    if (this.pointers.size === 2) {
      // A second finger starts a camera gesture and cancels the stroke.
      this.pendingPress = null;
      if (this.stroke) this.endStroke('drop');
      this.endGrab('drop');
      this.turning = null;
      this.startPinch();
      return;
    }
    const pans = e.button === 1 || e.button === 2 || e.shiftKey;
    if (this.studio.view.placeInHalf(place).isSecond) {
      // The shape beside is looked at only.
      this.turning = pans ? 'pan' : 'turn';
      this.moved = CLICK;
      return;
    }
    const clones = this.studio.isBrushOn && brush.effect === 'clone';
    if (clones && !pans && !this.studio.onPickVertex && (e.altKey || this.studio.cloneSource === null))
      this.studio.pickCloneSource();
    if ((this.studio.isGrabOn || clones) && !pans && e.button === 0 && !this.studio.onPickVertex) {
      this.endGrab('drop');
      const begun = { hit: null, began: false, at: place, moved: 0, released: false };
      this.grabbing = { pointer: e.pointerId, handle: -1, ...begun };
      void this.beginGrab(this.grabbing, place);
      return;
    }
    const picks =
      this.studio.isBrushOn && brush.effect === 'match' && (e.altKey || !this.studio.detail.isPicked);
    if (picks && !pans && !this.studio.onPickVertex) this.studio.detail.startPick();
    if (this.studio.isBrushOn && !pans && e.button === 0 && !this.studio.onPickVertex) {
      const pressure = e.pointerType === 'pen' && e.pressure > 0 ? 0.3 + 0.7 * e.pressure : 1;
      this.pendingPress = { id: e.pointerId, ...place, invert: e.ctrlKey || e.metaKey, pressure };
      void this.resolvePress(this.pendingPress);
      return;
    }
    this.turning = pans ? 'pan' : 'turn';
  }

  /** Decides by picking: on the surface the pointer pulls, pins or clones; off the surface it rotates the shape. */
  private async beginGrab(grabbing: Grabbing, { x, y }: { x: number; y: number }): Promise<void> {
    const { studio } = this;
    const mode = this.grabMode;
    grabbing.handle = mode === 'pull' ? this.grab.handleAt(x, y) : -1;
    const ray = studio.view.camera.ray(x, y);
    const { hit } = await studio.engine.call('pick', { ray, ring: null });
    if (this.grabbing !== grabbing) return;
    if (!hit && grabbing.handle < 0) {
      this.grabbing = null;
      if (this.pointers.has(grabbing.pointer)) this.turning = 'turn';
      return;
    }
    grabbing.hit = hit;
    if (mode !== 'pull' && hit) {
      this.grab.beginStroke(mode);
      grabbing.began = true;
      this.grab.touch(hit.vertex);
    } else if (!grabbing.released || grabbing.moved >= CLICK) {
      // A click needs no bound shape.
      grabbing.began = await this.grab.begin(grabbing.handle, hit, x, y);
      if (this.grabbing !== grabbing) {
        // Cancelled meanwhile.
        if (grabbing.began) this.grab.end('drop');
        return;
      }
      if (!grabbing.began) {
        this.grabbing = null;
        return;
      }
      if (grabbing.moved >= CLICK) this.grab.moveTo(grabbing.at.x, grabbing.at.y);
    }
    if (grabbing.released) this.endGrab('keep');
  }

  private get grabMode(): GrabMode | 'clone' {
    return this.studio.isGrabOn ? grab.mode : 'clone';
  }

  private touchOnce(vertex: number, mode: StrokeMode): void {
    this.grab.beginStroke(mode);
    this.grab.touch(vertex);
    this.grab.end('keep');
  }

  private moveGrab(place: { x: number; y: number }): void {
    const { grabbing, studio } = this;
    if (!grabbing?.began) return;
    if (this.grabMode === 'pull') {
      if (grabbing.moved >= CLICK) this.grab.moveTo(place.x, place.y);
      return;
    }
    const ray = studio.view.camera.ray(place.x, place.y);
    void studio.engine.call('pick', { ray, ring: null }).then(({ hit }) => {
      if (hit && this.grabbing === grabbing) this.grab.touch(hit.vertex);
    });
  }

  /** Ends a pull or a stroke of pins. A pull without a motion is a click: it pins the spot, or leaves the handle. */
  private endGrab(how: 'keep' | 'drop'): void {
    const { grabbing } = this;
    if (!grabbing) return;
    const clicked = this.grabMode === 'pull' && grabbing.moved < CLICK;
    if (how === 'keep' && !grabbing.began && !(clicked && grabbing.hit)) {
      // The surface under the press is not known yet, or the shape is not bound.
      grabbing.released = true;
      return;
    }
    this.grabbing = null;
    this.grab.end(clicked ? 'drop' : how);
    if (clicked && how === 'keep' && grabbing.handle < 0 && grabbing.hit)
      this.touchOnce(grabbing.hit.vertex, 'pin');
  }

  /** Keeps what was pulled so far. */
  interrupt(): void {
    this.endGrab(this.grabbing?.began ? 'keep' : 'drop');
  }

  /** Decides by picking: the brush paints on the surface; off the surface the pointer rotates the shape. */
  private async resolvePress(begun: NonNullable<Stage['pendingPress']>): Promise<void> {
    const { studio } = this;
    const shape = brushShape(studio, begun.pressure, begun.invert);
    const ray = studio.view.camera.ray(begun.x, begun.y);
    const answer = await studio.engine.call('pick', { ray, ring: null });
    if (this.pendingPress !== begun) {
      return;
    }
    this.pendingPress = null;
    if (!answer.hit) {
      if (this.pointers.has(begun.id)) this.turning = 'turn';
      return;
    }
    if (!(await this.chooseLayer(answer.hit, shape))) return;
    try {
      await studio.showMask(studio.layer, shape.mode === 'smooth' ? smoothingRadius(shape) : null);
    } catch (error) {
      studio.history.cancel();
      studio.showMessage((error as Error).message, 'error');
      return;
    }
    const scale = studio.view.camera.project(answer.hit.point).scale;
    this.stroke = {
      pointer: begun.id,
      key: studio.layer.key,
      shape,
      x: begun.x,
      y: begun.y,
      spacing: Math.max(2, SPACING * shape.radius * scale),
      rays: [ray],
      busy: false,
      ended: this.pointers.has(begun.id) ? null : 'keep',
      stamped: 0,
    };
    void this.paint();
  }

  /**
   * Selects the layer that a stroke goes to: one of the effect of the brush, or the present one with a region. If there is
   * none, it is created; layer and stroke are one undo step. Returns false if the brush has nothing to paint.
   */
  private async chooseLayer(hit: Hit, shape: BrushShape): Promise<boolean> {
    const { studio } = this;
    const { effect } = brush;
    if (effect === 'region') {
      if (studio.layer.region) return true;
      studio.addLayer(text.layerName(studio.layers.length + 1), { painted: [] }, false);
      studio.showMessage(text.paintedLayer);
      return true;
    }
    if (effect === 'clone') return false;
    if (effectOf(studio.layer) === effect) return true;
    const painted = studio.layers.findLast((l) => effectOf(l) === effect);
    // Detail is matched where the layer was begun.
    if (painted && effect !== 'match') {
      studio.select(painted.key);
      return true;
    }
    if (shape.mode !== 'add') {
      studio.showMessage(text.nothingToErase);
      return false;
    }
    const sigmas = studio.doc.levels.sigmas;
    const gains =
      effect === 'match'
        ? await studio.detail.gainsAt(hit.vertex, shape.radius)
        : effectGains(effect, sigmas, shape.radius);
    if (!gains) {
      studio.showMessage(text.noDetail);
      return false;
    }
    studio.addLayer(text.effects[effect], { painted: [] }, false, gains);
    return true;
  }

  private async paint(): Promise<void> {
    const { stroke, studio } = this;
    if (!stroke || stroke.busy) return;
    if (stroke.rays.length === 0) {
      if (stroke.ended) await this.commitStroke(stroke);
      return;
    }
    stroke.busy = true;
    const rays = stroke.rays.splice(0);
    try {
      const answer = await studio.engine.call('paint', {
        key: stroke.key,
        rays,
        brush: stroke.shape,
        ring: halfRadius(stroke.shape),
      });
      stroke.stamped += answer.stamped;
      if (answer.stamped) studio.timings.records.stamp.push(answer.stampTook);
      studio.view.showRing(answer.outer, answer.inner);
      studio.showSpectrum(answer.spectrum);
      if (answer.stamped) {
        studio.view.markMoving();
        studio.display.showTarget(false);
      }
    } catch (error) {
      studio.showMessage((error as Error).message, 'error');
      stroke.ended = 'drop';
    }
    stroke.busy = false;
    void this.paint();
  }

  private endStroke(how: 'keep' | 'drop'): void {
    if (!this.stroke) return;
    this.stroke.ended = how;
    if (how === 'drop') this.stroke.rays = [];
    void this.paint();
  }

  private async commitStroke(stroke: Stroke): Promise<void> {
    const { studio } = this;
    this.stroke = null;
    const keep = stroke.ended === 'keep' && stroke.stamped > 0;
    const layer = studio.findLayer(stroke.key);
    const region = layer ? appendStroke(layer.region, [], stroke.shape) : null;
    const child = region ? studio.regions.id(region) : -1;
    const { indices } = await studio.engine.call('paintEnd', {
      key: stroke.key,
      keep: keep && region !== null,
      child,
      brush: stroke.shape,
    });
    if (!keep || !region) {
      studio.history.cancel();
      studio.display.showTarget(true);
      return;
    }
    lastStamps(region).push(...indices);
    if (layer?.region) studio.regions.registerStroke(region, layer.region);
    studio.changeLayer({ region }, false, stroke.key);
    studio.history.end();
  }

  private onPointerMove(e: PointerEvent): void {
    const place = this.canvasPoint(e);
    const before = this.pointers.get(e.pointerId);
    if (!before) {
      this.hover(place);
      return;
    }
    const dx = place.x - before.x;
    const dy = place.y - before.y;
    this.moved += Math.abs(dx) + Math.abs(dy);
    this.pointers.set(e.pointerId, place);
    const { camera } = this.studio.view;
    if (this.pointers.size === 2) {
      this.movePinch();
    } else if (this.grabbing?.pointer === e.pointerId) {
      this.grabbing.at = place;
      this.grabbing.moved += Math.abs(dx) + Math.abs(dy);
      this.moveGrab(place);
      return;
    } else if (this.stroke?.pointer === e.pointerId) {
      // Browsers coalesce the samples of a frame; a stroke follows all of them.
      const samples = e.getCoalescedEvents?.() ?? [];
      for (const sample of samples.length ? samples : [e]) this.addRays(this.canvasPoint(sample));
      void this.paint();
      return;
    } else if (this.turning === 'turn') camera.turn(dx, dy);
    else if (this.turning === 'pan') camera.pan(dx, dy);
    else return;
    this.studio.view.markMoving();
  }

  /** Adds rays at even distances from the last stamp to the pointer. */
  private addRays(place: { x: number; y: number }): void {
    const stroke = this.stroke!;
    let length = Math.hypot(place.x - stroke.x, place.y - stroke.y);
    while (length >= stroke.spacing) {
      const t = stroke.spacing / length;
      stroke.x += (place.x - stroke.x) * t;
      stroke.y += (place.y - stroke.y) * t;
      stroke.rays.push(this.studio.view.camera.ray(stroke.x, stroke.y));
      length = Math.hypot(place.x - stroke.x, place.y - stroke.y);
    }
  }

  private onPointerUp(e: PointerEvent): void {
    if (!this.pointers.delete(e.pointerId)) return;
    if (this.grabbing?.pointer === e.pointerId) {
      this.endGrab(e.type === 'pointercancel' ? 'drop' : 'keep');
      return;
    }
    if (this.stroke?.pointer === e.pointerId) {
      this.endStroke(e.type === 'pointercancel' ? 'drop' : 'keep');
      return;
    }
    const clicked = this.moved < CLICK && this.turning === 'turn' && e.button === 0;
    if (this.pointers.size === 0) this.turning = null;
    else this.turning = 'turn';
    if (clicked) void this.click(this.canvasPoint(e));
  }

  /** Vertex under a point of the canvas; `null` off the surface. */
  async vertexAt(x: number, y: number): Promise<number | null> {
    const { engine, view } = this.studio;
    const { hit } = await engine.call('pick', { ray: view.camera.ray(x, y), ring: null });
    return hit?.vertex ?? null;
  }

  private async click(place: { x: number; y: number }): Promise<void> {
    const { studio } = this;
    const ray = studio.view.camera.ray(place.x, place.y);
    const answer = await studio.engine.call('pick', { ray, ring: null });
    if (answer.hit) studio.lastVertex = answer.hit.vertex;
    if (studio.onPickVertex) {
      if (!answer.hit) {
        studio.requestVertex(text.missed, studio.onPickVertex);
        return;
      }
      const next = studio.onPickVertex;
      studio.onPickVertex = null;
      next(answer.hit.vertex);
      return;
    }
    this.onClick?.(answer, place.x, place.y);
  }

  /** Cancels the current stroke, line or pick; returns false if there is none. */
  escape(): boolean {
    if (this.studio.cancelPick()) return true;
    if (this.grabbing) {
      this.endGrab('drop');
      return true;
    }
    if (!this.stroke) return false;
    this.endStroke('drop');
    return true;
  }

  private hover(place: { x: number; y: number }): void {
    if (this.studio.view.placeInHalf(place).isSecond) {
      this.onPointerLeave();
      return;
    }
    this.hoverNext = place;
    if (this.hovering || !this.studio.shape) return;
    this.hovering = true;
    void this.hoverLoop().finally(() => {
      this.hovering = false;
    });
  }

  private async hoverLoop(): Promise<void> {
    const { studio } = this;
    while (this.hoverNext) {
      const place = this.hoverNext;
      this.hoverNext = null;
      const shape = brushShape(studio, 1, false);
      const showsRing = studio.isBrushOn || (studio.isGrabOn && grab.mode !== 'pull');
      const ring = showsRing ? { radius: shape.radius, half: halfRadius(shape) } : null;
      const answer = await studio.engine.call('pick', {
        ray: studio.view.camera.ray(place.x, place.y),
        ring,
      });
      studio.timings.records.pick.push(answer.took);
      this.hoverAnswer = answer;
      if (showsRing && !this.stroke) {
        const { hit, outer } = answer;
        const flat = hit && !outer ? this.flatRing(hit, shape.radius) : null;
        studio.view.showRing(outer ?? flat, answer.inner);
        // The moving circle is drawn over the coarse version.
        studio.view.showRing(answer.outer ?? flat, answer.inner);
        studio.view.markMoving();
      }
      studio.showSpectrum(answer.spectrum);
      // More than one pick per frame would not be visible.
      await new Promise((done) => requestAnimationFrame(done));
    }
  }

  /** Circle of the brush where its edge on the surface is not known; `null` on a graph in space, which has no plane. */
  private flatRing(hit: Hit, radius: number): Float32Array | null {
    const graph = this.studio.shape?.graph;
    if (!graph) return flatRing(hit, radius);
    return graph.flat ? flatRing({ ...hit, normal: [0, 0, 1] }, radius) : null;
  }

  private onPointerLeave(): void {
    this.hoverNext = null;
    this.hoverAnswer = null;
    if (!this.stroke) this.studio.view.showRing(null, null);
  }

  get hovered(): PickAnswer | null {
    return this.hoverAnswer;
  }

  private onWheel(e: WheelEvent): void {
    e.preventDefault();
    const { x, y } = this.studio.view.placeInHalf(this.canvasPoint(e));
    const lines = e.deltaMode === 1 ? 16 : 1;
    if (this.studio.isBrushOn && e.altKey) {
      this.resizeBrush(e.deltaY > 0 ? 1 / 1.1 : 1.1);
      return;
    }
    const { hit } = this.hoverAnswer ?? { hit: null };
    if (hit) this.studio.view.camera.focusDepth(hit.point);
    this.studio.view.camera.zoom(Math.exp(Math.max(-60, Math.min(60, e.deltaY * lines)) * 0.0025), x, y);
    this.studio.view.markMoving();
    window.clearTimeout(this.looking);
    this.looking = window.setTimeout(() => void this.findShape(), LOOK);
  }

  /** Offers to fit the view if no part of the shape is seen. */
  private async findShape(): Promise<void> {
    const { studio } = this;
    if (!studio.shape || this.hoverAnswer?.hit) return;
    const { camera } = studio.view;
    const { width, height } = studio.view.part;
    for (let k = 0; k < LOOK_GRID ** 2; k++) {
      const x = ((k % LOOK_GRID) + 0.5) * (width / LOOK_GRID);
      const y = (Math.floor(k / LOOK_GRID) + 0.5) * (height / LOOK_GRID);
      if ((await this.vertexAt(x, y)) !== null) return;
    }
    const onclick = () => {
      camera.frame();
      studio.view.markMoving();
    };
    const withdraw = studio.showMessage(text.nothingSeen, 'info', { label: text.frame, onclick });
    // Another picture may show the shape again.
    studio.view.afterNextMove(withdraw);
  }

  resizeBrush(factor: number): void {
    brush.radius =
      Math.round(2 * Math.min(30, Math.max(0.5, brush.radius * factor + (factor > 1 ? 0.25 : -0.25)))) / 2;
    this.studio.emit('tool');
  }

  private async setPivot(e: MouseEvent): Promise<void> {
    const { x, y, isSecond } = this.studio.view.placeInHalf(this.canvasPoint(e));
    if (isSecond) return;
    const answer = await this.studio.engine.call('pick', {
      ray: this.studio.view.camera.ray(x, y),
      ring: null,
    });
    if (!answer.hit) return;
    this.studio.view.camera.setPivot(answer.hit.point);
    this.studio.view.markMoving();
  }

  private startPinch(): void {
    const [a, b] = [...this.pointers.values()] as [{ x: number; y: number }, { x: number; y: number }];
    this.pinch = {
      distance: Math.hypot(a.x - b.x, a.y - b.y),
      angle: Math.atan2(b.y - a.y, b.x - a.x),
      x: (a.x + b.x) / 2,
      y: (a.y + b.y) / 2,
    };
  }

  /** Two fingers: pinching zooms; moving together rotates in brush mode and pans otherwise. */
  private movePinch(): void {
    const { camera } = this.studio.view;
    const before = this.pinch;
    this.startPinch();
    const now = this.pinch;
    if (before.distance > 0 && now.distance > 0) camera.zoom(before.distance / now.distance, now.x, now.y);
    if (this.studio.isBrushOn) camera.turn(now.x - before.x, now.y - before.y);
    else camera.pan(now.x - before.x, now.y - before.y);
    camera.roll(now.angle - before.angle);
  }
}
