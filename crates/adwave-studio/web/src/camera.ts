/** Camera: rotates about a pivot, pans, and zooms to the cursor. */

import { Matrix4, PerspectiveCamera, Quaternion, Vector3 } from 'three';
import type { ClipEquation } from './clip';
import type { Ray } from './compute/pick';

export type ViewName = 'front' | 'back' | 'right' | 'left' | 'top' | 'bottom';

const DIRECTIONS: Record<ViewName, [number, number, number]> = {
  front: [0, 0, 1],
  back: [0, 0, -1],
  right: [1, 0, 0],
  left: [-1, 0, 0],
  top: [0, 1, 0],
  bottom: [0, -1, 0],
};

const FIELD_OF_VIEW = 30;
/** Part of the picture's width or height that a framed shape takes. */
const FILL = 0.92;
/** Smallest distance from the pivot in mean lengths of an edge, at which a part of one fills the picture. */
const CLOSEST = 0.5;

/** Everything that a camera keeps from one visit to the next, in coordinates relative to the center of the shape. */
export interface CameraState {
  quaternion: number[];
  pivot: number[];
  distance: number;
  up: 'y' | 'z';
  trackball: boolean;
}

/** True for a complete state; another version may have stored another one. */
export function isCameraState(x: unknown): x is CameraState {
  const state = x as CameraState | null;
  const finite = (list: unknown, n: number) =>
    Array.isArray(list) && list.length === n && list.every((v) => Number.isFinite(v));
  return (
    typeof state === 'object' &&
    state !== null &&
    finite(state.quaternion, 4) &&
    finite(state.pivot, 3) &&
    state.distance > 0 &&
    Number.isFinite(state.distance) &&
    (state.up === 'y' || state.up === 'z')
  );
}

export class Camera {
  readonly three = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
  readonly pivot = new Vector3();
  /** Plane beyond which nothing is picked. */
  clip: ClipEquation | null = null;
  distance = 1;
  trackball = false;
  /** True for a shape that is flat and looked at from above, of which a turn moves the picture. */
  isFlat = false;
  /** Vertices (x, y, z, …) that a frame holds; `null` frames the sphere. */
  outline: Float32Array | null = null;
  /** Upright axis. */
  up: 'y' | 'z' = 'y';
  private readonly center = new Vector3();
  private radius = 1;
  private closest = 1e-3;
  private company: { center: readonly number[]; radius: number } | null = null;
  /** Distance beyond the bounds at which vertices may be. */
  private reach = 0;
  private width = 1;
  private height = 1;

  /** Sets the sphere that holds a shape, and the mean length of its edges. */
  setBounds(center: readonly number[], radius: number, meanLength = 0): void {
    this.closest = Math.max(CLOSEST * meanLength, 1e-3 * (radius || 1));
    this.reach = 0;
    this.company = null;
    this.center.set(center[0]!, center[1]!, center[2]!);
    this.radius = radius || 1;
  }

  /** Sets the bounds of a shape that is shown beside, so that both are framed and none is clipped. */
  setCompany(bounds: { center: readonly number[]; radius: number } | null): void {
    this.company = bounds;
    this.update();
  }

  /** Radius about the center of the shape that holds the one beside it too. */
  private get wholeRadius(): number {
    const { company } = this;
    if (!company) return this.radius;
    const away = this.center.distanceTo(new Vector3(...(company.center as [number, number, number])));
    return Math.max(this.radius, away + company.radius);
  }

  resize(width: number, height: number): void {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    this.three.aspect = this.width / this.height;
    this.update();
  }

  /** A camera that sees at least as much in a picture of another size. */
  copy({ width, height }: { width: number; height: number }): Camera {
    const other = new Camera();
    other.setBounds(this.center.toArray(), this.radius);
    other.closest = this.closest;
    other.restore(this.state);
    other.reach = this.reach;
    const narrow = Math.min(1, width / height / this.three.aspect);
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360) / narrow;
    other.three.fov = (360 / Math.PI) * Math.atan(half);
    other.resize(width, height);
    return other;
  }

  private upVector(): Vector3 {
    return this.up === 'y' ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
  }

  /** Direction from the pivot to the viewer. */
  toward(): number[] {
    return this.three.getWorldDirection(new Vector3()).negate().toArray();
  }

  /** Direction to the right of the picture. */
  right(): number[] {
    return new Vector3(1, 0, 0).applyQuaternion(this.three.quaternion).toArray();
  }

  /** Direction up in the picture. */
  upward(): number[] {
    return new Vector3(0, 1, 0).applyQuaternion(this.three.quaternion).toArray();
  }

  /** Looks at the center from where the shape, or the spheres of two, fill the picture. */
  frame(): void {
    this.pivot.copy(this.center);
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    this.distance =
      (this.company ? 0 : this.outlineDistance(FILL * half * this.three.aspect, FILL * half)) ||
      this.wholeRadius / Math.sin(Math.atan(half * Math.min(1, this.three.aspect)));
    this.update();
  }

  /** Distance from the center at which all of the outline is within slopes from the direction of view; 0 without one. */
  private outlineDistance(slopeX: number, slopeY: number): number {
    const [right, up, toward] = [this.right(), this.upward(), this.toward()];
    const center = this.center.toArray();
    const along = (axis: number[], x: number, y: number, z: number) =>
      axis[0]! * x + axis[1]! * y + axis[2]! * z;
    let distance = 0;
    const p = this.outline ?? [];
    for (let i = 0; i < p.length; i += 3) {
      const [x, y, z] = [p[i]! - center[0]!, p[i + 1]! - center[1]!, p[i + 2]! - center[2]!];
      const across = Math.max(
        Math.abs(along(right, x, y, z)) / slopeX,
        Math.abs(along(up, x, y, z)) / slopeY,
      );
      const depth = along(toward, x, y, z);
      // The eye stays as far before the nearest vertex as that is before the pivot.
      distance = Math.max(distance, depth + Math.max(across, depth));
    }
    return distance;
  }

  look(name: ViewName): void {
    if (this.isFlat) return;
    const direction = new Vector3(...DIRECTIONS[name]);
    if (this.up === 'z') direction.set(direction.x, -direction.z, direction.y);
    this.lookFrom(direction);
  }

  /** Looks at the pivot from a direction. */
  lookFrom(direction: Vector3): void {
    const up = this.upVector();
    if (Math.abs(direction.clone().normalize().dot(up)) > 0.999)
      up.set(0, this.up === 'y' ? 0 : 1, this.up === 'y' ? -1 : 0);
    const matrix = new Matrix4().lookAt(direction, new Vector3(), up);
    this.three.quaternion.setFromRotationMatrix(matrix);
    this.update();
  }

  /** Resets to the start view: front, slightly from above and from the side. */
  start(): void {
    const direction = this.isFlat ? new Vector3(0, 0, 1) : new Vector3(0.45, 0.28, 1);
    if (this.up === 'z' && !this.isFlat) direction.set(direction.x, -direction.z, direction.y);
    this.lookFrom(direction);
    this.frame();
  }

  get state(): CameraState {
    const { pivot, distance, up, trackball } = this;
    return { quaternion: this.three.quaternion.toArray(), pivot: pivot.toArray(), distance, up, trackball };
  }

  restore(state: CameraState): void {
    this.up = state.up;
    this.trackball = state.trackball === true;
    this.three.quaternion.fromArray(state.quaternion).normalize();
    this.pivot.fromArray(state.pivot);
    this.distance = Math.min(this.radius * 50, Math.max(this.closest, state.distance));
    this.update();
  }

  level(): void {
    this.lookFrom(new Vector3(0, 0, 1).applyQuaternion(this.three.quaternion));
  }

  /** Sets the distance by which vertices may have left the bounds, so that they are not clipped. */
  setReach(reach: number): void {
    if (reach === this.reach) return;
    this.reach = reach;
    this.update();
  }

  /** Point in the plane through `place` that is parallel to the picture, seen at (x, y) of the canvas. */
  pointInPlane(place: readonly number[], x: number, y: number): number[] {
    const { origin, direction } = this.ray(x, y);
    const toward = this.toward();
    const along = (v: readonly number[]) => v.reduce((sum, c, i) => sum + c * toward[i]!, 0);
    const depth = along(place.map((c, i) => c - origin[i]!)) / along(direction);
    return direction.map((c, i) => origin[i]! + depth * c);
  }

  /** Rotates by a pointer movement in pixels. */
  turn(dx: number, dy: number): void {
    if (this.isFlat) {
      this.pan(dx, dy);
      return;
    }
    const q = this.three.quaternion;
    const speed = Math.PI / Math.min(this.width, this.height);
    const pitch = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), -dy * speed);
    if (this.trackball) {
      const yaw = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), -dx * speed);
      q.multiply(yaw).multiply(pitch);
    } else {
      const up = this.upVector();
      const yaw = new Quaternion().setFromAxisAngle(up, -dx * speed);
      const turned = yaw.multiply(q.clone().multiply(pitch));
      // The turntable stops before the pole, where it would flip.
      const above = new Vector3(0, 1, 0).applyQuaternion(turned).dot(up);
      if (above > 0.01 || above > new Vector3(0, 1, 0).applyQuaternion(q).dot(up)) q.copy(turned);
      else q.premultiply(new Quaternion().setFromAxisAngle(up, -dx * speed));
    }
    q.normalize();
    this.update();
  }

  roll(angle: number): void {
    if (!this.trackball || this.isFlat) return;
    this.three.quaternion.multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), angle));
    this.update();
  }

  /** Size of a pixel at the pivot, in model units. */
  get pixel(): number {
    return (2 * this.distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360)) / this.height;
  }

  pan(dx: number, dy: number): void {
    const move = new Vector3(-dx, dy, 0).multiplyScalar(this.pixel).applyQuaternion(this.three.quaternion);
    this.pivot.add(move);
    this.update();
  }

  /** Multiplies the distance by `factor` and keeps the point under (x, y) of the canvas fixed. */
  zoom(factor: number, x: number, y: number): void {
    const next = Math.min(this.radius * 50, Math.max(this.closest, this.distance * factor));
    const f = next / this.distance;
    const place = new Vector3((x - this.width / 2) * this.pixel, (this.height / 2 - y) * this.pixel, 0)
      .applyQuaternion(this.three.quaternion)
      .multiplyScalar(1 - f);
    this.pivot.add(place);
    this.distance = next;
    this.update();
  }

  /** Moves the pivot along the direction of view to the depth of a point, so that zooming stops in front of it. */
  focusDepth(point: readonly number[]): void {
    const forward = this.three.getWorldDirection(new Vector3());
    const eye = this.three.position;
    const depth =
      forward.x * (point[0]! - eye.x) + forward.y * (point[1]! - eye.y) + forward.z * (point[2]! - eye.z);
    if (!(depth > this.three.near)) return;
    this.distance = depth;
    this.pivot.copy(eye).addScaledVector(forward, depth);
    this.update();
  }

  setPivot(point: readonly number[]): void {
    this.pivot.set(point[0]!, point[1]!, point[2]!);
    this.update();
  }

  update(): void {
    const back = new Vector3(0, 0, this.distance).applyQuaternion(this.three.quaternion);
    this.three.position.copy(this.pivot).add(back);
    const away = this.three.position.distanceTo(this.center);
    const { wholeRadius: radius, reach } = this;
    this.three.near = Math.max(away - 2 * radius - reach, this.distance * 0.01, radius * 1e-4);
    this.three.far = away + 3 * radius + reach;
    this.three.updateProjectionMatrix();
    this.three.updateMatrixWorld();
  }

  /** Ray through a point of the canvas. */
  ray(x: number, y: number): Ray {
    const through = new Vector3((2 * x) / this.width - 1, 1 - (2 * y) / this.height, 0.5).unproject(
      this.three,
    );
    const from = this.three.position;
    const direction = through.sub(from).normalize();
    return {
      origin: [from.x, from.y, from.z],
      direction: [direction.x, direction.y, direction.z],
      pixel: this.pixel / this.distance,
      clip: this.clip,
    };
  }

  /** Projects a point to the canvas; `scale` is in pixels per model unit there. */
  project(point: readonly number[]): { x: number; y: number; scale: number } {
    const p = new Vector3(point[0]!, point[1]!, point[2]!);
    const depth = p.clone().sub(this.three.position).dot(this.three.getWorldDirection(new Vector3()));
    p.project(this.three);
    return {
      x: ((p.x + 1) / 2) * this.width,
      y: ((1 - p.y) / 2) * this.height,
      scale: this.height / (2 * depth * Math.tan((FIELD_OF_VIEW * Math.PI) / 360)),
    };
  }
}
