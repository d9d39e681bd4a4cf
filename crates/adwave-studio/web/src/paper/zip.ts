/** Writer of ZIP archives without compression, for files that are compressed already. */

import { crc32 } from './crc';

/** Largest size of an archive without the extensions for large ones. */
const MOST = 2 ** 32 - 1;
/** Version 2.0, and names in UTF-8. */
const VERSION = 20;
const UTF8 = 0x800;
/** 1 January 1980, so that the same files give the same archive. */
const DATE = 0x21;

interface Entry {
  name: Uint8Array<ArrayBuffer>;
  check: number;
  size: number;
  at: number;
}

export class ZipWriter {
  private readonly parts: BlobPart[] = [];
  private readonly entries: Entry[] = [];
  private size = 0;

  /** Adds a file; its name has no folders. */
  async add(name: string, content: Blob): Promise<void> {
    const entry = {
      name: new TextEncoder().encode(name),
      check: crc32(new Uint8Array(await content.arrayBuffer())),
      size: content.size,
      at: this.size,
    };
    const head = numbers([0x04034b50, 4], ...shared(entry), [0, 2]);
    const size = this.size + head.length + entry.name.length + content.size;
    if (size > MOST)
      throw new Error('The archive must be below 4 GB. Choose fewer frames or a smaller size.');
    this.parts.push(head, entry.name, content);
    this.entries.push(entry);
    this.size = size;
  }

  finish(): Blob {
    const list = this.entries.flatMap((entry) => [
      numbers(
        [0x02014b50, 4],
        [VERSION, 2],
        ...shared(entry),
        // No extra fields, comments, disks and attributes.
        [0, 2],
        [0, 2],
        [0, 2],
        [0, 2],
        [0, 4],
        [entry.at, 4],
      ),
      entry.name,
    ]);
    const length = list.reduce((sum, part) => sum + part.length, 0);
    const n = this.entries.length;
    const end = numbers([0x06054b50, 4], [0, 2], [0, 2], [n, 2], [n, 2], [length, 4], [this.size, 4], [0, 2]);
    return new Blob([...this.parts, ...list, end], { type: 'application/zip' });
  }
}

/** Fields that the head of a file and its entry in the list have in common. */
function shared({ name, check, size }: Entry): [number, number][] {
  return [
    [VERSION, 2],
    [UTF8, 2],
    // Not compressed.
    [0, 2],
    [0, 2],
    [DATE, 2],
    [check, 4],
    [size, 4],
    [size, 4],
    [name.length, 2],
  ];
}

/** Numbers with their sizes in bytes, little-endian. */
function numbers(...list: [number, number][]): Uint8Array<ArrayBuffer> {
  const view = new DataView(new ArrayBuffer(list.reduce((sum, [, n]) => sum + n, 0)));
  let at = 0;
  for (const [value, n] of list) {
    if (n === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += n;
  }
  return new Uint8Array(view.buffer);
}
