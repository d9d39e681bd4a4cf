/** The frames of a series: a slider below the picture, and a button that plays them. */

import { h, iconButton } from './dom';
import { formatNumber } from './lengths';
import type { FieldName, Shape } from './protocol';
import { text } from './text';

/** Frames per second while they play, unless the server is slower. */
const RATE = 12;

/** Frames of the series that a field belongs to, in order; a single one if it belongs to none. */
export function framesOf(shape: Shape, name: string): FieldName[] {
  const field = shape.fields.find((f) => f.name === name);
  const series = field?.series?.name;
  if (!field || series === undefined) return field ? [field] : [];
  return shape.fields.filter((f) => f.series?.name === series);
}

/** Time of a frame after the first in words; empty if the file does not say it. */
export function timeOf(step: number | null, frame: number): string {
  if (step === null) return '';
  const seconds = step * frame;
  return step >= 0.1 || seconds === 0
    ? `${formatNumber(seconds, 4)} s`
    : `${formatNumber(1000 * seconds, 4)} ms`;
}

/** A frame with the series that it belongs to. */
type Frame = Pick<FieldName, 'name' | 'series'>;

export interface FrameBar<F extends Frame = FieldName> {
  element: HTMLElement;
  /** Shows the frames of a series and which of them the picture shows; hides the bar for fewer than two. */
  set(frames: readonly F[], at: number): void;
  /** Stops playing, and shows the frame that is `by` frames later. */
  step(by: number): void;
  stop(): void;
  /** Resolves once the latest frame that was asked for is shown. */
  waitUntilShown(): Promise<void>;
}

/** Shows one frame at a time; of those asked for meanwhile, the latest follows unless it is cleared. */
function latestOnly<F>(show: (frame: F, rest: boolean) => Promise<void>) {
  let wanted: [F, boolean] | null = null;
  let running: Promise<void> | null = null;
  const run = async () => {
    try {
      while (wanted) {
        const next: [F, boolean] = wanted;
        wanted = null;
        await show(...next);
      }
    } finally {
      running = null;
    }
  };
  return {
    clear: () => {
      wanted = null;
    },
    /** Resolves once the frame is shown, at once if that of an earlier call is under way. */
    show: (frame: F, rest: boolean): Promise<void> => {
      wanted = [frame, rest];
      if (running) return Promise.resolve();
      running = run();
      return running;
    },
    waitUntilShown: () => running ?? Promise.resolve(),
  };
}

/**
 * Creates the bar. `show` shows a frame; it is called with `rest = true` once the picture comes to rest on it. The next
 * frame waits until the one before is shown.
 */
export function frameBar<F extends Frame>(show: (frame: F, rest: boolean) => Promise<void>): FrameBar<F> {
  let frames: readonly F[] = [];
  let at = 0;
  /** Counter of plays; 0 while none runs, and a loop of an earlier one ends. */
  let playing = 0;
  let turn = 0;
  const label = h('output', {});
  const input = h('input', { type: 'range', min: '0', max: '0', step: '1', 'aria-label': text.frameSlider });
  const play = iconButton('play', text.play, () => (playing ? rest() : void run()));
  const element = h('div', { class: 'frame-bar', hidden: true }, play, input, label);

  const latest = latestOnly(show);
  const showAt = (isRest: boolean) => latest.show(frames[at]!, isRest);

  function place(frame: number): void {
    at = frame;
    input.value = String(frame);
    const time = timeOf(frames[frame]?.series?.step ?? null, frame);
    label.textContent = text.frameOf(frame + 1, frames.length, time);
    input.setAttribute('aria-valuetext', label.textContent);
  }

  function setPlaying(on: boolean): void {
    playing = on ? ++turn : 0;
    play.setAttribute('aria-pressed', String(on));
    play.setAttribute('aria-label', on ? text.pause : text.play);
    play.title = on ? text.pause : text.play;
    play.classList.toggle('playing', on);
  }

  async function run(): Promise<void> {
    setPlaying(true);
    const mine = playing;
    while (playing === mine && frames.length > 1) {
      const due = performance.now() + 1000 / RATE;
      place((at + 1) % frames.length);
      await showAt(false);
      await new Promise((resolve) => setTimeout(resolve, Math.max(0, due - performance.now())));
      // A hidden page plays nothing.
      if (document.hidden && playing === mine) rest();
    }
  }

  /** Stops on the present frame. */
  function rest(): void {
    setPlaying(false);
    void showAt(true);
  }

  input.addEventListener('input', () => {
    if (playing) setPlaying(false);
    place(input.valueAsNumber);
    void showAt(false);
  });
  input.addEventListener('change', () => void showAt(true));

  return {
    element,
    set: (next, frame) => {
      const isSame = next.length === frames.length && next[0]?.name === frames[0]?.name;
      if (!isSame) {
        latest.clear();
        if (playing) setPlaying(false);
      }
      frames = next;
      element.hidden = frames.length < 2;
      input.max = String(Math.max(0, frames.length - 1));
      if (!element.hidden && !playing) place(Math.max(0, frame));
    },
    step: (by) => {
      if (frames.length < 2) return;
      place(Math.min(frames.length - 1, Math.max(0, at + by)));
      rest();
    },
    stop: () => {
      if (playing) setPlaying(false);
    },
    waitUntilShown: latest.waitUntilShown,
  };
}
