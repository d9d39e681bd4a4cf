/** Modal dialog with a title and a close button. */

import { h, iconButton } from './dom';
import { text } from './text';

export function dialog(title: string, ...content: (Node | null)[]): HTMLDialogElement {
  const box = h('dialog', { 'aria-label': title });
  box.append(
    h(
      'header',
      {},
      h('h2', {}, title),
      iconButton('close', text.close, () => box.close()),
    ),
    h('div', { class: 'content' }, ...content),
  );
  box.addEventListener('close', () => box.remove());
  // A click outside closes the dialog.
  box.addEventListener('pointerdown', (event) => {
    if (event.target !== box) return;
    const r = box.getBoundingClientRect();
    if (
      event.clientX < r.left ||
      event.clientX > r.right ||
      event.clientY < r.top ||
      event.clientY > r.bottom
    ) {
      box.close();
    }
  });
  document.body.append(box);
  box.showModal();
  return box;
}
