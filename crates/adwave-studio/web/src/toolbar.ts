/** Tools beside the picture, exactly one of which the pointer has. */

import { h, type IconName, iconButton } from './dom';
import type { PointerTool, Studio } from './studio';
import { text } from './text';

const ICONS: Record<PointerTool, IconName> = { look: 'turn', brush: 'brush', grab: 'hand' };

export function toolbar(studio: Studio): HTMLElement {
  const tools = Object.keys(ICONS) as PointerTool[];
  const buttons = tools.map((tool) =>
    iconButton(ICONS[tool], text.pointerTools[tool], () => studio.setTool(tool)),
  );
  const show = () => {
    for (const [i, button] of buttons.entries())
      button.setAttribute('aria-pressed', String(tools[i] === studio.tool));
  };
  studio.on('tool', show);
  studio.on('shape', () => {
    // A graph is not bent.
    const bends = !studio.shape?.graph;
    buttons[tools.indexOf('grab')]!.hidden = !bends;
    if (!bends && studio.isGrabOn) studio.setTool('look');
  });
  show();
  return h('div', { class: 'toolbar', role: 'group', 'aria-label': text.pointer }, ...buttons);
}
