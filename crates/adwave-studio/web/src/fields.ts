/** Fields that a region may use. */

import type { FieldName, Shape } from './protocol';

/** Lists fields of the file and computed fields. Band fields exist in recipes for dyadic levels only. */
export function regionFields(shape: Shape): FieldName[] {
  const dyadic = shape.levels.every((l) => l.steps === 2 ** (l.level - 1));
  return shape.fields.filter(
    (f) => f.name !== 'change' && !f.rgb && !f.channel && (dyadic || !/^band-\d+$/.test(f.name)),
  );
}

/** Default field of a new region: the first of the file, otherwise saliency. */
export function firstField(shape: Shape): FieldName | undefined {
  const fields = regionFields(shape);
  return fields.find((f) => !f.edited && !/^band-\d+$/.test(f.name)) ?? fields[0];
}
