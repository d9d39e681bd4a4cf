/** How long things take, for tests and the curious. */

export interface Timings {
  firstPixels: number;
  firstSlider: number;
  slidersLive: number;
  slider: number[];
  settle: number[];
  pick: number[];
  stamp: number[];
  /** A frame from its first call until it is finished. */
  frame: number[];
}

export class Watch {
  readonly timings: Timings = {
    firstPixels: 0,
    firstSlider: 0,
    slidersLive: 0,
    slider: [],
    settle: [],
    pick: [],
    stamp: [],
    frame: [],
  };
  /** Set by tests: each frame waits until it is finished and is timed. */
  measuring = false;
  private moved = 0;

  /** A slider was moved now: the next frame says how long it took to be seen. */
  sliderTouched(): void {
    this.moved ||= performance.now();
  }

  sliderLeft(): void {
    this.moved = 0;
  }

  /** A frame was drawn, of the present document or not; `finish` waits until it is done. */
  frameDrawn(began: number, isPresent: boolean, finish: () => void): void {
    if (!this.measuring) {
      this.moved = 0;
      return;
    }
    if (!this.moved || !isPresent) return;
    const since = this.moved;
    this.moved = 0;
    finish();
    this.timings.slider.push(performance.now() - since);
    this.timings.frame.push(performance.now() - began);
  }
}
