/** Writer of PNG files row by row, so that a picture may be larger than the largest canvas of the browser. */

import { crc32 } from './crc';

const SIGNATURE = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
/** Filters of rows: differences to the pixel on the left, and to the row above. */
const SUB = 1;
const UP = 2;

/** Picture of 8-bit red, green, blue and opacity; colors are not multiplied by the opacity. */
export class PngWriter {
  private readonly parts: BlobPart[];
  private readonly packed: WritableStreamDefaultWriter<BufferSource>;
  private readonly done: Promise<void>;
  private above: Uint8Array<ArrayBuffer>;

  constructor(
    readonly width: number,
    readonly height: number,
  ) {
    const head = new DataView(new ArrayBuffer(13));
    head.setUint32(0, width);
    head.setUint32(4, height);
    // Eight bits per channel, color with opacity.
    head.setUint8(8, 8);
    head.setUint8(9, 6);
    this.parts = [new Uint8Array(SIGNATURE), ...chunk('IHDR', new Uint8Array(head.buffer))];
    this.above = new Uint8Array(4 * width);
    const { writable, readable } = new CompressionStream('deflate');
    this.packed = writable.getWriter();
    this.done = this.collect(readable.getReader());
  }

  private async collect(reader: ReadableStreamDefaultReader<Uint8Array<ArrayBuffer>>): Promise<void> {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      this.parts.push(...chunk('IDAT', value));
    }
  }

  /** Appends whole rows, from the top, `u8 × 4` each pixel. */
  async write(rows: Uint8Array): Promise<void> {
    const stride = 4 * this.width;
    const n = rows.length / stride;
    const out = new Uint8Array(n * (stride + 1));
    for (let y = 0; y < n; y++) {
      const row = rows.subarray(y * stride, (y + 1) * stride);
      this.filter(row, out.subarray(y * (stride + 1), (y + 1) * (stride + 1)));
      this.above.set(row);
    }
    await this.packed.write(out);
  }

  /** Writes the filter whose differences are smaller, and the differences. */
  private filter(row: Uint8Array, out: Uint8Array): void {
    const { above } = this;
    let [left, up] = [0, 0];
    for (let i = 0; i < row.length; i++) {
      left += Math.abs(((row[i]! - (i < 4 ? 0 : row[i - 4]!)) << 24) >> 24);
      up += Math.abs(((row[i]! - above[i]!) << 24) >> 24);
    }
    const isUp = up <= left;
    out[0] = isUp ? UP : SUB;
    for (let i = 0; i < row.length; i++) out[i + 1] = row[i]! - (isUp ? above[i]! : i < 4 ? 0 : row[i - 4]!);
  }

  async finish(): Promise<Blob> {
    await this.packed.close();
    await this.done;
    return new Blob([...this.parts, ...chunk('IEND', new Uint8Array(0))], { type: 'image/png' });
  }

  /** Gives up the picture. */
  async abort(): Promise<void> {
    this.done.catch(() => {});
    await this.packed.abort().catch(() => {});
  }
}

function chunk(type: string, content: Uint8Array<ArrayBuffer>): Uint8Array<ArrayBuffer>[] {
  const name = new TextEncoder().encode(type);
  const length = new DataView(new ArrayBuffer(4));
  length.setUint32(0, content.length);
  const check = new DataView(new ArrayBuffer(4));
  check.setUint32(0, crc32(content, crc32(name)));
  return [new Uint8Array(length.buffer), name, content, new Uint8Array(check.buffer)];
}
