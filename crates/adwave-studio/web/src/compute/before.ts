/** What a mask was before a stroke, at the vertices that the stroke touched. Kept from stroke to stroke, so that one costs what it touches. */
export class Before {
  private vertices = new Uint32Array(1024);
  private size = 0;
  private readonly values: Uint8Array;
  private readonly isTouched: Uint8Array;

  constructor(n: number) {
    this.values = new Uint8Array(n);
    this.isTouched = new Uint8Array(n);
  }

  /** The value of a vertex, unless an earlier one is kept. */
  keep(v: number, value: number): void {
    if (this.isTouched[v] === 1) return;
    this.isTouched[v] = 1;
    this.values[v] = value;
    if (this.size === this.vertices.length) {
      const larger = new Uint32Array(2 * this.size);
      larger.set(this.vertices);
      this.vertices = larger;
    }
    this.vertices[this.size++] = v;
  }

  /** The value of a vertex before the stroke: `now` where the stroke has not touched it. */
  value(v: number, now: number): number {
    return this.isTouched[v] === 1 ? this.values[v]! : now;
  }

  /** The vertices, in the order in which they were touched. */
  get touched(): Uint32Array {
    return this.vertices.subarray(0, this.size);
  }

  /** Puts the values back into a mask. */
  restore(bytes: Uint8Array): void {
    for (const v of this.touched) bytes[v] = this.values[v]!;
  }

  /** For another stroke. */
  clear(): void {
    for (const v of this.touched) this.isTouched[v] = 0;
    this.size = 0;
  }
}
