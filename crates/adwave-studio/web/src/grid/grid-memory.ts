/** Window, shading, place, frame and zoom of each image and volume, remembered by the browser from one visit to the next. */

import type { Shape } from '../protocol';
import type { GridLook } from './grid-view';
import { isShadeMode } from './shade';

/** Enlargement of a pane, and the indices in its middle. */
export interface PaneMemory {
  zoom: number;
  middle: [number, number];
}

export interface GridMemory {
  look: GridLook;
  cross: number[];
  /** Frame of a series that is shown; 0 without frames. */
  frame: number;
  panes: PaneMemory[];
}

const KEY = 'adwave-grids';
/** Number of images and volumes that are remembered. */
const MOST = 40;

function readAll(): [string, GridMemory][] {
  try {
    const list = JSON.parse(localStorage.getItem(KEY) ?? '[]') as [string, GridMemory][];
    return Array.isArray(list) ? list : [];
  } catch {
    return [];
  }
}

/** A file at another place with the same sizes has the same name here; its view fits it as well. */
function nameOf(shape: Shape): string {
  return `${shape.name} ${shape.grid!.sizes.join('×')}`;
}

export function rememberGrid(shape: Shape, memory: GridMemory): void {
  const others = readAll().filter(([name]) => name !== nameOf(shape));
  try {
    localStorage.setItem(KEY, JSON.stringify([...others.slice(1 - MOST), [nameOf(shape), memory]]));
  } catch {
    // Without storage the next visit begins with the usual view.
  }
}

export function recallGrid(shape: Shape): GridMemory | null {
  const found = readAll().find(([name]) => name === nameOf(shape))?.[1];
  return found && isGridMemory(found, shape.grid!.sizes) ? found : null;
}

/** True for a complete memory of a grid of these sizes; another version may have stored another one. */
export function isGridMemory({ look, cross, frame, panes }: GridMemory, sizes: readonly number[]): boolean {
  const finite = (list: unknown, n: number) =>
    Array.isArray(list) && list.length === n && list.every((x) => Number.isFinite(x));
  const isPane = (pane: PaneMemory) => pane?.zoom > 0 && Number.isFinite(pane.zoom) && finite(pane.middle, 2);
  return (
    isShadeMode(look?.mode) &&
    finite(look.window, 2) &&
    look.window[0] < look.window[1] &&
    look.relief > 0 &&
    finite(cross, sizes.length) &&
    Number.isInteger(frame) &&
    frame >= 0 &&
    Array.isArray(panes) &&
    panes.every(isPane)
  );
}
