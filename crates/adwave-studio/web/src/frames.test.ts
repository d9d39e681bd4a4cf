import { describe, expect, it } from 'vitest';
import { framesOf, timeOf } from './frames';
import type { FieldName, Shape } from './protocol';

const field = (name: string, series: string | null): FieldName => ({
  name,
  label: name,
  unit: '',
  edited: false,
  series: series === null ? null : { name: series, step: 2 },
});

describe('frames', () => {
  const fields = [field('bold 1', 'bold'), field('age', null), field('bold 2', 'bold'), field('x 1', 'x')];
  const shape = { fields } as Shape;

  it('lists the frames of one series in order', () => {
    expect(framesOf(shape, 'bold 2').map((f) => f.name)).toEqual(['bold 1', 'bold 2']);
    expect(framesOf(shape, 'age').map((f) => f.name)).toEqual(['age']);
    expect(framesOf(shape, 'gone')).toEqual([]);
  });

  it('writes times in the unit of the step', () => {
    expect(timeOf(2, 90)).toBe('180 s');
    expect(timeOf(0.002, 7)).toBe('14 ms');
    expect(timeOf(0.002, 0)).toBe('0 s');
    expect(timeOf(null, 7)).toBe('');
  });
});
