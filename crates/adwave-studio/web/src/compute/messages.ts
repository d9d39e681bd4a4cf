/** What the page and its worker say to each other. */

import type { BrushStroke, Region } from '../protocol';
import type { Hit, Ray } from './pick';

export interface WorkerLayer {
  key: number;
  on: boolean;
  opacity: number;
  gains: number[];
  /** Names a region that was sent once; null acts everywhere. */
  region: number | null;
}

export type BrushMode = 'add' | 'subtract' | 'smooth';

/** A region by its number: whole, or a painted one with one stroke more. */
export type RegionNews = [number, Region | { extends: number; stroke: BrushStroke }];

export interface BrushShape {
  radius: number;
  falloff: number;
  strength: number;
  mode: BrushMode;
  /** Paints only what faces this direction; null: all within the radius. */
  facing: { direction: number[]; falloff: number } | null;
  /** Mirror the stamped vertices at x = this, in relative coordinates; null: no symmetry. */
  mirror: number | null;
}

export type Scalar = { band: number } | 'change';

/** Requests that are answered, by name: [what is sent, what comes back]. */
export interface Calls {
  shape: [
    {
      url: string;
      token: string;
      n: number;
      center: number[];
      diagonal: number;
      meanLength: number;
      cloud: boolean;
      positions: Float32Array;
      triangles: Uint32Array;
    },
    { normals: Int8Array },
  ];
  edges: [Record<string, never>, { pairs: Uint32Array }];
  bands: [{ nLevels: number; shared: boolean }, { seconds: number }];
  edit: [{ layers: WorkerLayer[]; regions: RegionNews[]; exact: boolean }, EditAnswer];
  /** Builds what picking and painting need, before they need it. */
  warm: [Record<string, never>, Record<string, never>];
  /** Makes sure that the mask of a layer is that of its region, and is ready to be smoothed by a length. */
  mask: [{ key: number; id: number; regions: RegionNews[]; smoothing: number | null }, Record<string, never>];
  /** The mask of a layer, for tests. */
  maskBytes: [{ key: number }, { bytes: Uint8Array }];
  pick: [{ ray: Ray; ring: { radius: number; half: number } | null }, PickAnswer];
  paint: [{ key: number; rays: Ray[]; brush: BrushShape; ring: number }, PaintAnswer];
  paintEnd: [{ key: number; keep: boolean; child: number; brush: BrushShape }, PaintEndAnswer];
  scalar: [Scalar, { values: Float32Array }];
  energy: [{ key: number | null; vertex: number | null; radius: number }, { rms: number[] }];
  /** Normals of other positions of the same vertices. */
  normals: [{ positions: Float32Array }, { normals: Int8Array }];
  positions: [Record<string, never>, { positions: Float32Array }];
}

export interface EditAnswer {
  positions: Float32Array;
  normals: Int8Array;
  greatest: number;
  rms: number;
  volume: number | null;
  /** Why a layer was left out. */
  problem: string | null;
  /** Milliseconds of computing. */
  took: number;
}

export interface PickAnswer {
  hit: Hit | null;
  /** |W_j| at the vertex that was hit. */
  spectrum: number[];
  /** Segments of the circle at the brush's radius, then of that at half weight: [x, y, z] of both ends. */
  outer: Float32Array | null;
  inner: Float32Array | null;
  took: number;
}

export interface PaintAnswer extends PickAnswer {
  stamped: number;
  /** Milliseconds of one stamp. */
  stampTook: number;
}

export interface PaintEndAnswer {
  indices: number[];
}

export type Call = keyof Calls;

export type ToWorker = { [C in Call]: { id: number; call: C; with: Calls[C][0] } }[Call];

/** What the worker says unasked. */
export type News =
  | { news: 'band'; level: number; scale: number; values: Int16Array; at: number }
  | { news: 'mask'; key: number; from: number; bytes: Uint8Array };

export type FromWorker = { id: number; answer: unknown } | { id: number; error: string } | News;
