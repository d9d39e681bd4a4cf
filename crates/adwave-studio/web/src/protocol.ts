/** Types of requests and responses, as described in PROTOCOL.md. */

export type Place = { vertex: number } | { point: number[] };
export type Length = number | string;

export type Region =
  | { vertices: { indices: number[]; radius: Length; falloff?: Length } }
  | { stroke: { path: Place[]; radius: Length; falloff?: Length } }
  | { ball: { center: Place; radius: Length; falloff?: Length } }
  | { box: { min: number[]; max: number[]; falloff?: Length } }
  | { 'half-space': { point: number[]; normal: number[]; falloff?: Length } }
  | { field: { name: string; low: number; high: number } }
  | { facing: { direction: number[]; falloff?: number } }
  | { component: { vertex: number } }
  | { grown: { by: Length; region: Region } }
  | { blurred: { by: Length; region: Region } }
  | { faded: { factor: number; region: Region } }
  | { painted: BrushStroke[] }
  | { not: Region }
  | { any: Region[] }
  | { all: Region[] };

/**
 * One stroke of a brush with region weights r on a mask m: max(m, r), min(m, 1 − r), or m + r · (blurred m − m).
 */
export type BrushStroke = { add: Region } | { subtract: Region } | { smooth: { region: Region; by: Length } };

export interface Layer {
  name: string;
  on: boolean;
  opacity: number;
  gains: number[];
  region: Region | null;
  /** Name of the preset that the gains were set to last. */
  preset?: string | undefined;
}

export type Along = 'free' | 'normal' | 'surface' | 'x' | 'y' | 'z';
export type Border = 'natural' | 'keep' | 'free';
export type VolumeRule = 'free' | 'keep';

/** Name and eye of a clone or a handle; without them it has the usual name and an effect. */
export interface Listed {
  name?: string;
  on?: boolean;
}

/** Vertices that move together: about their center by a turn (axis times degrees), and then by a vector. */
export interface PoseHandle extends Listed {
  by: number[];
  turn?: number[];
  region: Region;
}

/** Handles that bend the shape after all else. */
export interface Pose {
  width?: Length;
  stiffness?: Length;
  /** Share of lengths, 0 to 1; 0 if absent. */
  keep_lengths?: number;
  fixed?: Region | null;
  /** False if the pins have no effect. */
  pinned?: boolean;
  handle: PoseHandle[];
}

/** Detail cloned from around a vertex to others, one after the other. */
export interface DetailClone extends Listed {
  source: number;
  targets: number[];
  radius: Length;
  angle?: number;
  strength?: number;
}

/** Edits beside those of bands. */
export interface ReshapedBy {
  clones: readonly DetailClone[];
  pose: Pose | null;
}

export interface Edit {
  revision: number;
  layers: Layer[];
  along: Along | null;
  border: Border | null;
  volume: VolumeRule | null;
  clones?: readonly DetailClone[];
  pose?: Pose | null;
  /** First vertices of the parts whose faces are turned over in saved files, ascending. */
  turned?: readonly number[];
  /** Edits of fields, each by layers of its own. */
  fields?: readonly FieldEdit[];
}

export interface FieldEdit {
  field: string;
  layers: Layer[];
  /** False if the edit of the field has no effect. */
  on?: boolean;
}

export interface Level {
  level: number;
  steps: number;
  sigma: number;
  fwhm: number;
}

/** Choice of levels that the server turns into the same levels again. */
export interface LevelsChoice {
  levels?: number;
  voices?: number;
  steps?: number[];
  lengths?: Length[];
}

/** Levels that replaced others, and the stored edit with gains of these levels. */
export interface LevelsAnswer {
  levels: Level[];
  choice: LevelsChoice;
  edit: Edit;
  /** Field that an opened recipe edits; `null` for the positions. */
  field?: string | null;
}

export interface FieldName {
  name: string;
  label: string;
  unit: string;
  edited: boolean;
  /** True for the colors of the file, which have no single value per vertex. */
  rgb?: boolean;
  /** True for fields with bands of their own, which can be edited. */
  editable?: boolean;
  /** True for one channel of a field of several, which regions cannot use. */
  channel?: boolean;
  /** Series of which the field is a frame, with the seconds between frames. */
  series?: { name: string; step: number | null } | null;
}

/** Slice of a volume on the screen, or a whole image. */
export interface SliceView {
  name: string;
  /** Axis that is fixed in a slice; `null` for an image. */
  fixed: number | null;
  /** Axes that run down and to the right. */
  axes: [number, number];
  /** True for an axis whose index grows upward, or to the left. */
  flips: [boolean, boolean];
  /** Names of the directions at the left, right, lower and upper edge; empty without names. */
  edges: [string, string, string, string];
}

/** Places of an image or a volume; lists have an entry for each axis. */
export interface GridInfo {
  sizes: number[];
  spacings: number[];
  axes: string[];
  origin: [number, number, number];
  steps: [number, number, number][];
  unit: string | null;
  views: SliceView[];
  /** Number of values of a place that are shown together: 1 in a series. */
  n_channels: number;
  /** Frames of a series, with the seconds between them; `null` for other images and volumes. */
  frames: { n: number; step: number | null } | null;
  value_type: string;
  n_missing: number;
  /** Largest and root mean square change by the stored edit. */
  change: { greatest: number; rms: number };
  /** True if the values are heights of a map. */
  terrain: boolean;
  /** Spacings in the unit of the heights. */
  height_spacings: number[];
  range: { least: number; greatest: number; low: number; high: number };
  /** Endings of file names by the names of the formats that can be written. */
  extensions: Record<string, string>;
}

/** Edges of a graph or a curve, and how they are shown. */
export interface GraphInfo {
  n_edges: number;
  /** True if all nodes lie in one plane of constant z, which is looked at from above. */
  flat: boolean;
  /** True if the file has no positions: the server placed the nodes, and the fields alone can be edited. */
  placed: boolean;
  /** True if the file has names for the nodes. */
  named: boolean;
}

export interface Shape {
  id: number;
  name: string;
  /** Format of the file; `null` for a built-in shape. */
  format: string | null;
  formats: string[];
  kind: string;
  n_vertices: number;
  n_triangles: number;
  center: [number, number, number];
  diagonal: number;
  mean_length: number;
  closed: boolean;
  volume: number | null;
  components: number;
  /** Closed parts whose faces point inward, the largest first; `vertex` is the first of the part. */
  inward?: { vertex: number; n_faces: number; volume: number }[];
  notes: string[];
  levels: Level[];
  choice: LevelsChoice;
  fields: FieldName[];
  presets: { name: string; gains: number[] }[];
  resumed: boolean;
  /** Places of an image or a volume; none for a shape. */
  grid?: GridInfo;
  /** Edges of a graph or a curve; `null` for another shape. */
  graph?: GraphInfo | null;
}

/** True if faces of a closed surface or of closed parts of it point inward. */
export function facesPointInward({ inward }: Shape): boolean {
  return (inward ?? []).length > 0;
}

/** True if most faces point inward, so that the seen side is their back. */
export function isInsideOut({ inward, n_triangles }: Shape): boolean {
  return 2 * (inward ?? []).reduce((n, part) => n + part.n_faces, 0) > n_triangles;
}

export interface EditSummary {
  revision: number;
  greatest: number;
  rms: number;
  volume: [number, number] | null;
}

export interface Feature {
  vertex: number;
  position: [number, number, number];
  level: number;
  sigma: number;
  strength: number;
  sign: number;
}

export interface FieldInfo {
  label: string;
  unit: string;
  diverging: boolean;
}

/** A format that can be read. */
export interface ReadableFormat {
  title: string;
  extensions: string[];
}

/** Contents of a tab. */
export interface OpenedName {
  id: number;
  name: string;
  domain: 'shape' | 'grid';
}

export interface ShapeList {
  version: string;
  shapes: OpenedName[];
}

export type CompareMethod = 'taubin' | 'harmonics';

/** Summary of the distances of a shape from another. */
export interface Deviation {
  /** True if distances are positive where the other shape lies outside. */
  signed: boolean;
  /** `null` if no vertex has a distance. */
  rms: number | null;
  mean: number | null;
  greatest: number | null;
  /** Number of points whose closest point is on a border, which have no distance. */
  beyond_border: number;
}

export interface Comparison {
  how: { degree: number; frequency: number } | { harmonics: number; t: number };
  /** Root mean square distance of a vertex from the mean of its neighbors, in model units. */
  roughness: { before: number; edit: number; other: number };
  /** Root mean square displacement, in model units. */
  rms: { edit: number; other: number };
}
