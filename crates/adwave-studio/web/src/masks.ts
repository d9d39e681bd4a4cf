/** Masks of the layers in the slots of the shader. */

import type { ShapeArrays } from './arrays';
import type { DocLayer } from './state';

export class Masks {
  private readonly masks = new Map<number, Uint8Array>();
  /** Layer key of each slot. */
  private slots: number[] = [];
  private n = 0;

  constructor(private readonly arrays: ShapeArrays) {}

  /** Resets for another shape. */
  reset(nVertices: number): void {
    this.n = nVertices;
    this.masks.clear();
    this.slots = [];
  }

  /** Updates a mask from a vertex on, as reported by the worker. */
  updateMask(key: number, from: number, bytes: Uint8Array): void {
    let mask = this.masks.get(key);
    if (!mask) {
      mask = new Uint8Array(this.n);
      this.masks.set(key, mask);
    }
    mask.set(bytes, from);
    const slot = this.slot(key);
    if (slot >= 0) this.arrays.setMask(slot, from, bytes);
  }

  /**
   * Drops the masks of deleted layers, as the worker does. When undo brings a layer back, the worker computes its mask from
   * the region and reports it.
   */
  retainLayers(keys: readonly number[]): void {
    for (const key of this.masks.keys()) if (!keys.includes(key)) this.masks.delete(key);
  }

  /** Number of masks in memory. */
  get size(): number {
    return this.masks.size;
  }

  has(key: number): boolean {
    return this.masks.has(key);
  }

  /** Slot of a layer; −1 if it has none. */
  slot(key: number): number {
    return this.slots.indexOf(key);
  }

  /** Assigns slots to the layers that have a region. */
  assignSlots(layers: readonly DocLayer[]): void {
    const slots = layers.filter((l) => l.region).map((l) => l.key);
    if (slots.length === this.slots.length && slots.every((k, i) => k === this.slots[i])) return;
    const old = this.slots;
    this.slots = slots;
    for (const [slot, key] of slots.entries()) {
      const mask = this.masks.get(key);
      if (mask && old[slot] !== key) this.arrays.setMask(slot, 0, mask);
      else if (!mask && this.n > 0) this.arrays.setMask(slot, 0, new Uint8Array(this.n));
    }
  }
}
