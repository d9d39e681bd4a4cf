import { expect, test } from 'vitest';
import { gainSummary } from './gain-summary';
import { isGridMemory } from './grid/grid-memory';

test('a layer names its preset and the bands that differ from it', () => {
  const presets = [{ name: 'enhance', gains: [3, 2, 1] }];
  const summary = (gains: number[], preset?: string, what: 'all' | 'presets' = 'all') =>
    gainSummary({ gains, preset }, presets, what);
  expect(summary([3, 2, 1], 'enhance')).toBe('Enhance');
  expect(summary([3, 1, 1], 'enhance')).toBe('Enhance, 1 band changed');
  expect(summary([1, 1, 1], 'enhance')).toBe('Enhance, 2 bands changed');
  // With no band left of it the preset is gone.
  expect(summary([0, 0, 0], 'enhance')).toBe('3 bands changed');
  expect(summary([1, 1, 1])).toBe('');
  expect(summary([1, 0, 2])).toBe('2 bands changed');
  expect(summary([1, 0, 2], undefined, 'presets')).toBe('');
  expect(summary([1, 0, 1], 'of another version')).toBe('1 band changed');
});

test('the view of a volume is recalled only if it is complete', () => {
  const memory = {
    look: { mode: 'gray' as const, window: [0, 5] as [number, number], relief: 1, smooth: false },
    cross: [1, 2, 3],
    frame: 3,
    panes: [{ zoom: 2, middle: [4, 5] as [number, number] }],
  };
  expect(isGridMemory(memory, [10, 10, 10])).toBe(true);
  expect(isGridMemory(memory, [10, 10])).toBe(false);
  expect(isGridMemory({ ...memory, frame: 0.5 }, [10, 10, 10])).toBe(false);
  expect(isGridMemory({ ...memory, look: { ...memory.look, window: [5, 5] } }, [10, 10, 10])).toBe(false);
  expect(isGridMemory({ ...memory, panes: [{ zoom: 0, middle: [4, 5] }] }, [10, 10, 10])).toBe(false);
});
