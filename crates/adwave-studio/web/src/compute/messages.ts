/** Messages between the page and its worker. */

import type { BrushStroke, Region, ReshapedBy } from '../protocol';
import type { Hit, Ray } from './pick';

export interface WorkerLayer {
  key: number;
  on: boolean;
  opacity: number;
  gains: number[];
  /** Number of a region that was sent before; `null` is the whole shape. */
  region: number | null;
}

export type BrushMode = 'add' | 'subtract' | 'smooth';

/** Number and content of a region: complete, or as a stroke appended to another one. */
export type RegionUpdate = [number, Region | { extends: number; stroke: BrushStroke }];

export interface BrushShape {
  radius: number;
  falloff: number;
  strength: number;
  mode: BrushMode;
  /** Paints only vertices that face this direction; `null` paints all within the radius. */
  facing: { direction: number[]; falloff: number } | null;
  /** Mirror plane x = mirror, in coordinates relative to the center; `null` turns mirroring off. */
  mirror: number | null;
}

export type Scalar = { band: number } | 'change';

/** Requests by name: [parameters, result]. */
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
      /** Two nodes for each edge of a graph or a curve; `null` for another shape. */
      edges: Uint32Array | null;
      /** True if distances are numbers of edges. */
      countsEdges: boolean;
    },
    { normals: Int8Array },
  ];
  /** Takes triangles of which some are turned over; returns the normals of the unedited shape. */
  turn: [{ triangles: Uint32Array }, { normals: Int8Array }];
  edges: [Record<string, never>, { pairs: Uint32Array }];
  bands: [{ nLevels: number; shared: boolean }, { seconds: number }];
  edit: [
    {
      layers: WorkerLayer[];
      regions: RegionUpdate[];
      /** Keys of all layers of the document, whose masks are kept. */
      keep: number[];
      exact: boolean;
      by: ReshapedBy | null;
      follow: Follow;
    },
    EditAnswer,
  ];
  /** Takes the values of a field and then its bands, `f32 × n` each, to be edited; `null` drops those of the last one. */
  field: [{ values: Float32Array | null }, Record<string, never>];
  /** Values of the field after layers. */
  fieldEdit: [{ layers: WorkerLayer[]; regions: RegionUpdate[]; keep: number[] }, FieldAnswer];
  /** Sets the vertices that are drawn while the shape moves. */
  drawn: [{ vertices: Uint32Array }, Record<string, never>];
  /** Clones and bends the shape with unchanged bands: all vertices, or those that are drawn while it moves. */
  bend: [{ by: ReshapedBy; follow: Follow; drawn: boolean }, Bent];
  /** Distance by which a pose moves a vertex at rest. */
  shift: [{ vertex: number }, { by: number[] }];
  /** Prepares picking and painting in advance. */
  warm: [Record<string, never>, Record<string, never>];
  /** Updates the mask of a layer to its region, and prepares softening by a blur length. */
  mask: [
    { key: number; id: number; regions: RegionUpdate[]; smoothing: number | null },
    Record<string, never>,
  ];
  /** Mask of a layer, for tests. */
  maskBytes: [{ key: number }, { bytes: Uint8Array }];
  pick: [{ ray: Ray; ring: { radius: number; half: number } | null }, PickAnswer];
  paint: [{ key: number; rays: Ray[]; brush: BrushShape; ring: number }, PaintAnswer];
  paintEnd: [{ key: number; keep: boolean; child: number; brush: BrushShape }, PaintEndAnswer];
  scalar: [Scalar, { values: Float32Array }];
  energy: [{ key: number | null; vertex: number | null; radius: number }, { rms: number[] }];
  /** Normals for other positions of the same vertices. */
  normals: [{ positions: Float32Array }, { normals: Int8Array }];
  /** Normals of another shape; a cloud has no triangles. */
  normalsOf: [{ positions: Float32Array; triangles: Uint32Array }, { normals: Int8Array }];
  positions: [Record<string, never>, { positions: Float32Array }];
}

/** One step towards the handles, while one is pulled, or to rest. */
export type Follow = 'step' | 'rest';

/** Places of the shape with unchanged bands, with its clones and in its pose, and the rotations of its detail: quaternions x, y, z, w. */
export interface Bent {
  places: Float32Array;
  turns: Int16Array;
}

export interface EditAnswer {
  positions: Float32Array;
  normals: Int8Array;
  greatest: number;
  rms: number;
  volume: number | null;
  /** Clones and pose, if they have changed since the last answer. */
  places: Float32Array | null;
  turns: Int16Array | null;
  /** Message about a layer that was skipped. */
  problem: string | null;
  /** Computing time in milliseconds. */
  took: number;
}

export interface FieldAnswer {
  values: Float32Array;
  /** Largest and root mean square change, of the vertices with a value. */
  greatest: number;
  rms: number;
  /** Message about a layer that was skipped. */
  problem: string | null;
}

export interface PickAnswer {
  hit: Hit | null;
  /** |W_j| at the hit vertex, of the field that is edited or of the positions. */
  spectrum: number[];
  /** Segments of the circle at the radius of the brush and at half weight (`inner`): [x, y, z] of both ends. */
  outer: Float32Array | null;
  inner: Float32Array | null;
  took: number;
}

export interface PaintAnswer extends PickAnswer {
  stamped: number;
  /** Time of one stamp in milliseconds. */
  stampTook: number;
}

export interface PaintEndAnswer {
  indices: number[];
}

export type Call = keyof Calls;

export type ToWorker = { [C in Call]: { id: number; call: C; with: Calls[C][0] } }[Call];

/** Messages that the worker sends unprompted. */
export type WorkerEvent =
  | { event: 'band'; level: number; scale: number; values: Int16Array; at: number }
  | { event: 'mask'; key: number; from: number; bytes: Uint8Array };

export type FromWorker = { id: number; answer: unknown } | { id: number; error: string } | WorkerEvent;
