/** Binary heap of numbered entries: the smallest key comes first, and of equal keys the smallest number. */
export class Heap {
  size = 0;
  private keys = new Float64Array(1024);
  private numbers = new Uint32Array(1024);

  /** Key of the first entry. */
  get firstKey(): number {
    return this.keys[0]!;
  }

  /** Number of the first entry. */
  get firstNumber(): number {
    return this.numbers[0]!;
  }

  push(key: number, number: number): void {
    if (this.size === this.keys.length) this.grow();
    const { keys, numbers } = this;
    let i = this.size++;
    while (i > 0) {
      const up = (i - 1) >> 1;
      const k = keys[up]!;
      if (k < key || (k === key && numbers[up]! <= number)) break;
      keys[i] = k;
      numbers[i] = numbers[up]!;
      i = up;
    }
    keys[i] = key;
    numbers[i] = number;
  }

  /** Removes the first entry. */
  pop(): void {
    const { keys, numbers } = this;
    const size = --this.size;
    const key = keys[size]!;
    const number = numbers[size]!;
    let i = 0;
    for (;;) {
      let child = 2 * i + 1;
      if (child >= size) break;
      const right = child + 1;
      if (
        right < size &&
        (keys[right]! < keys[child]! || (keys[right] === keys[child] && numbers[right]! < numbers[child]!))
      ) {
        child = right;
      }
      const k = keys[child]!;
      if (key < k || (key === k && number <= numbers[child]!)) break;
      keys[i] = k;
      numbers[i] = numbers[child]!;
      i = child;
    }
    keys[i] = key;
    numbers[i] = number;
  }

  private grow(): void {
    const keys = new Float64Array(2 * this.size);
    keys.set(this.keys);
    this.keys = keys;
    const numbers = new Uint32Array(2 * this.size);
    numbers.set(this.numbers);
    this.numbers = numbers;
  }
}
