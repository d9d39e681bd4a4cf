/** Sentences of the list of the edit. */

export const editListText = {
  /** The preset of a layer, and the number of bands that were changed since. */
  presetChanged: (preset: string, n: number) =>
    n === 0 ? preset : `${preset}, ${n} ${n === 1 ? 'band' : 'bands'} changed`,
  bandsChanged: (n: number) => `${n} ${n === 1 ? 'band' : 'bands'} changed`,
  onTop: 'On top of the layers',
  cloneItem: (k: number) => `Clone ${k}`,
  cloneNote: (source: number, n: number) => `from vertex ${source}, ${n} ${n === 1 ? 'stamp' : 'stamps'}`,
  handleItem: (k: number) => `Handle ${k}`,
  handleNote: (vertex: number | null, by: string) =>
    `${vertex === null ? 'a region' : `vertex ${vertex}`}, moved by ${by}`,
  pinsItem: 'Pins',
  pinsNote: (n: number) => `${n} pinned ${n === 1 ? 'place' : 'places'}`,
  turnedItem: 'Turned part',
  turnedNote: (vertex: number) => `at vertex ${vertex}`,
  fieldItem: (field: string) => `Field ${field}`,
  moveUp: (name: string) => `Move ${name} up`,
  moveDown: (name: string) => `Move ${name} down`,
  itemRename: (name: string) => `Name of ${name}`,
};
