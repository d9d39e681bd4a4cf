/** Camera, shading and colors of each shape, remembered by the browser from one visit to the next. */

import { type Camera, type CameraState, isCameraState } from './camera';
import type { Clip } from './clip';
import type { Shape } from './protocol';

export interface ViewMemory {
  camera: CameraState;
  style: string;
  colors: string;
  /** Field that the equalizer edits; `null` for the positions. */
  target?: string | null;
  /** Plane that cuts the shape; `null` if it is whole. */
  clip?: Clip | null;
}

const KEY = 'adwave-views';
/** Number of shapes that are remembered. */
const MOST = 40;
/** Formats of scanners and of medicine, whose third axis points up. */
const UPRIGHT_Z = ['las', 'laz', 'e57', 'pcd', 'gifti', 'freesurfer', 'cifti', 'mgh'];

/** A file at another place with as many vertices has the same name here; its view fits it as well. */
function nameOf(shape: Shape): string {
  return `${shape.name} ${shape.n_vertices}`;
}

function readAll(): [string, ViewMemory][] {
  try {
    const list = JSON.parse(localStorage.getItem(KEY) ?? '[]') as [string, ViewMemory][];
    return Array.isArray(list) ? list : [];
  } catch {
    return [];
  }
}

export function rememberView(shape: Shape, memory: ViewMemory): void {
  const others = readAll().filter(([name]) => name !== nameOf(shape));
  try {
    localStorage.setItem(KEY, JSON.stringify([...others.slice(1 - MOST), [nameOf(shape), memory]]));
  } catch {
    // Without storage the next visit begins with the default view.
  }
}

export function recallView(shape: Shape): ViewMemory | null {
  const found = readAll().find(([name]) => name === nameOf(shape))?.[1];
  return found && isCameraState(found.camera) ? found : null;
}

/** Upright axis of a shape that was not opened before. */
export function uprightAxis(shape: Pick<Shape, 'format' | 'name'>): 'y' | 'z' {
  const format = shape.format?.toLowerCase() ?? '';
  return UPRIGHT_Z.some((f) => format.startsWith(f)) ? 'z' : 'y';
}

/** Places the camera as it was at the last visit, or at the start view of the format. */
export function placeCamera(camera: Camera, shape: Shape): void {
  const memory = recallView(shape);
  if (memory) {
    camera.restore(memory.camera);
    return;
  }
  camera.trackball = false;
  camera.up = uprightAxis(shape);
  camera.start();
}

/** Reads a view from the text of a file; `null` if it is none. */
export function parseView(content: string): ViewMemory | null {
  try {
    const view = JSON.parse(content) as ViewMemory | null;
    return view && isCameraState(view.camera) ? view : null;
  } catch {
    return null;
  }
}
