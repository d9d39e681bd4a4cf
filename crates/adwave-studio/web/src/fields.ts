/** Which fields a region may name. */

import type { FieldName, Shape } from './protocol';

/** Fields of the file, and what the shape gives itself. Bands by number only where they are those that a recipe knows: dyadic ones. */
export function regionFields(shape: Shape): FieldName[] {
  const dyadic = shape.levels.every((l) => l.steps === 2 ** (l.level - 1));
  return shape.fields.filter((f) => f.name !== 'change' && (dyadic || !/^band-\d+$/.test(f.name)));
}

/** The field that a region by field begins with: of the file, else saliency. */
export function firstField(shape: Shape): FieldName | undefined {
  const fields = regionFields(shape);
  return fields.find((f) => !f.edited && !/^band-\d+$/.test(f.name)) ?? fields[0];
}
