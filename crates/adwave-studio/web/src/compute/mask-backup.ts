/** Values of a mask before a stroke, at the vertices that it changed. Reused, so that a stroke costs what it changes. */
export class MaskBackup {
  private vertices = new Uint32Array(1024);
  private size = 0;
  private readonly values: Uint8Array;
  private readonly isSaved: Uint8Array;

  constructor(n: number) {
    this.values = new Uint8Array(n);
    this.isSaved = new Uint8Array(n);
  }

  /** Saves the value of a vertex, unless one is saved already. */
  saveValue(v: number, value: number): void {
    if (this.isSaved[v] === 1) return;
    this.isSaved[v] = 1;
    this.values[v] = value;
    if (this.size === this.vertices.length) {
      const larger = new Uint32Array(2 * this.size);
      larger.set(this.vertices);
      this.vertices = larger;
    }
    this.vertices[this.size++] = v;
  }

  /** Value of a vertex before the stroke; `now` if the stroke has not changed it. */
  value(v: number, now: number): number {
    return this.isSaved[v] === 1 ? this.values[v]! : now;
  }

  /** Changed vertices, in the order of their changes. */
  get changedVertices(): Uint32Array {
    return this.vertices.subarray(0, this.size);
  }

  /** Restores the values of a mask. */
  restore(bytes: Uint8Array): void {
    for (const v of this.changedVertices) bytes[v] = this.values[v]!;
  }

  /** Clears the backup for another stroke. */
  clear(): void {
    for (const v of this.changedVertices) this.isSaved[v] = 0;
    this.size = 0;
  }
}
