/** Access to the state of the page for end-to-end tests, as `window.studio`; part of builds with `--mode e2e` only. */

import type { Edit } from './protocol';
import { toEdit } from './state';
import type { Studio } from './studio';
import type { TimingRecords } from './timings';

export interface TestHooks {
  /** Resolves when the shape is drawn and every slider is enabled. */
  ready: Promise<void>;
  /** Returns the edit in the form sent to the server. */
  state(): Edit;
  /** Milliseconds since navigation, or durations of each kind of work. */
  timings: TimingRecords;
  /** Turns on timing of frames, each of which is then waited for. */
  measure(on: boolean): void;
  /** Returns the displayed positions after all computation has finished. */
  positions(): Promise<Float32Array>;
  /** Resolves when the server has stored every step. */
  saved(): Promise<void>;
  /** Returns the mask of the last layer after all computation has finished. */
  mask(): Promise<Uint8Array>;
  /** Number of masks in the memory of the page, after all computation has finished. */
  maskCount(): Promise<number>;
  /** Returns the displayed values of the field that is edited; `null` if the positions are. */
  fieldValues(): Promise<Float32Array | null>;
  /** Edited values of the panes of an image or a volume after all computation has finished, as they are loaded. */
  planes(): Promise<Float32Array[]>;
  /** Name of the WebGL renderer. */
  renderer: string;
}

declare global {
  interface Window {
    studio: TestHooks;
  }
}

export function installTestHooks(studio: Studio, ready: Promise<void>): void {
  const waiters: (() => void)[] = [];
  const isSaved = () => studio.saver?.state === 'saved' && !studio.saver.hasUnsavedStep;
  studio.on('saving', () => {
    if (studio.saver?.state === 'saved') for (const resolve of waiters.splice(0)) resolve();
  });
  window.studio = {
    ready,
    state: () => toEdit(studio.doc, 0),
    timings: studio.timings.records,
    measure: (on) => {
      studio.timings.isEnabled = on;
    },
    positions: async () => {
      await studio.display.waitUntilSettled();
      return (await studio.engine.call('positions', {})).positions;
    },
    mask: async () => {
      await studio.display.waitUntilSettled();
      return (await studio.engine.call('maskBytes', { key: studio.layers.at(-1)!.key })).bytes;
    },
    maskCount: async () => {
      await studio.display.waitUntilSettled();
      return studio.masks.size;
    },
    fieldValues: async () => {
      await studio.fieldEditor.waitUntilShown();
      return studio.fieldEditor.values;
    },
    planes: async () => {
      await studio.gridView.frames.waitUntilShown();
      await studio.gridView.waitUntilSettled();
      return studio.gridView.editedPlanes;
    },
    saved: () => (isSaved() ? Promise.resolve() : new Promise((resolve) => waiters.push(resolve))),
    renderer: studio.view.rendererName,
  };
}
