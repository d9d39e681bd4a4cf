/** Durations of loading, drawing and computing, for tests. */

export interface TimingRecords {
  firstPixels: number;
  firstSlider: number;
  slidersLive: number;
  slider: number[];
  settle: number[];
  pick: number[];
  stamp: number[];
  /** Time from a motion of a handle to the picture of the bent shape. */
  pull: number[];
  /** Duration of a frame from its first call until it is finished. */
  frame: number[];
}

export class Timings {
  readonly records: TimingRecords = {
    firstPixels: 0,
    firstSlider: 0,
    slidersLive: 0,
    slider: [],
    settle: [],
    pick: [],
    stamp: [],
    pull: [],
    frame: [],
  };
  /** Set by tests: each frame is waited for and timed. */
  isEnabled = false;
  private sliderMovedAt = 0;

  /** Starts the clock of a slider movement, which the next frame stops. */
  startSliderTiming(): void {
    this.sliderMovedAt ||= performance.now();
  }

  cancelSliderTiming(): void {
    this.sliderMovedAt = 0;
  }

  /** Records a frame; `isPresent` tells if it shows the present document, `finish` waits for the GPU. */
  recordFrame(began: number, isPresent: boolean, finish: () => void): void {
    if (!this.isEnabled) {
      this.sliderMovedAt = 0;
      return;
    }
    if (!this.sliderMovedAt || !isPresent) return;
    const since = this.sliderMovedAt;
    this.sliderMovedAt = 0;
    finish();
    this.records.slider.push(performance.now() - since);
    this.records.frame.push(performance.now() - began);
  }
}
