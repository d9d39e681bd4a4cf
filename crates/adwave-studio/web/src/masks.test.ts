import { describe, expect, test } from 'vitest';
import type { ShapeArrays } from './arrays';
import { Masks } from './masks';
import { newLayer } from './state';

describe('masks of layers', () => {
  /** Slots as the shader has them. */
  const shader = () => {
    const slots: Uint8Array[] = [];
    const setMask = (slot: number, from: number, bytes: Uint8Array) => {
      slots[slot] ??= new Uint8Array(4);
      slots[slot].set(bytes, from);
    };
    return { slots, arrays: { setMask } as unknown as ShapeArrays };
  };
  const region = { vertices: { indices: [1], radius: 1 } };

  test('a deleted layer has no mask, and gets it again with its next report', () => {
    const { slots, arrays } = shader();
    const masks = new Masks(arrays);
    masks.reset(4);
    const layers = ['a', 'b'].map((name) => newLayer(name, 1, region));
    const [a, b] = layers.map((l) => l.key) as [number, number];
    masks.assignSlots(layers);
    masks.updateMask(a, 0, Uint8Array.of(1, 2, 3, 4));
    masks.updateMask(b, 0, Uint8Array.of(5, 6, 7, 8));
    masks.assignSlots(layers.slice(1));
    masks.retainLayers([b]);
    expect([masks.size, masks.has(a), masks.has(b)]).toEqual([1, false, true]);
    expect([...slots[0]!]).toEqual([5, 6, 7, 8]);
    // Undo: the slots are as before, and empty until the worker reports the mask.
    masks.assignSlots(layers);
    expect(slots.map((s) => [...s])).toEqual([
      [0, 0, 0, 0],
      [5, 6, 7, 8],
    ]);
    masks.updateMask(a, 0, Uint8Array.of(1, 2, 3, 4));
    expect([...slots[0]!]).toEqual([1, 2, 3, 4]);
    expect(masks.size).toBe(2);
  });
});
