/** The wipe of images and volumes: left of a divider over all panes the values before the edit are shown. */

import { h } from '../dom';
import { text } from '../text';

/** Share of the width that stays on each side. */
const EDGE = 0.02;

export interface Wipe {
  readonly divider: HTMLElement;
  /** Place of the divider relative to the width of all panes; `null` without a wipe. */
  readonly at: number | null;
  toggle(): void;
}

/** Creates the divider; `changed` is called after it moved. */
export function gridWipe(changed: () => void): Wipe {
  let at: number | null = null;
  const divider = h(
    'div',
    {
      class: 'divider',
      hidden: true,
      role: 'slider',
      tabIndex: 0,
      'aria-label': text.split,
      'aria-valuemin': '0',
      'aria-valuemax': '100',
    },
    h('span', {}, text.beforeShort),
    h('span', {}, text.afterShort),
  );
  const place = (next: number | null) => {
    at = next === null ? null : Math.min(1 - EDGE, Math.max(EDGE, next));
    divider.hidden = at === null;
    if (at !== null) {
      divider.style.left = `${100 * at}%`;
      divider.setAttribute('aria-valuenow', String(Math.round(100 * at)));
    }
    changed();
  };
  divider.addEventListener('pointerdown', (e) => divider.setPointerCapture(e.pointerId));
  divider.addEventListener('pointermove', (e) => {
    if (!divider.hasPointerCapture(e.pointerId)) return;
    const { left, width } = divider.parentElement!.getBoundingClientRect();
    place((e.clientX - left) / width);
  });
  divider.addEventListener('keydown', (e) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1 }[e.key];
    if (step === undefined) return;
    e.preventDefault();
    e.stopPropagation();
    place((at ?? 0.5) + step);
  });
  return {
    divider,
    get at() {
      return at;
    },
    toggle: () => place(at === null ? 0.5 : null),
  };
}
