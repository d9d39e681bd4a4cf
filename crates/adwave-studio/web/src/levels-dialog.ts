/** Dialog that chooses the levels: automatic, by number with voices, or by widths. */

import { dialog } from './dialog';
import { h } from './dom';
import { formatNumber } from './lengths';
import type { Studio } from './studio';
import { text } from './text';

export function openLevels(studio: Studio): void {
  const { shape } = studio;
  if (!shape) return;
  const how = h(
    'select',
    { 'aria-label': text.levels, onchange: () => show() },
    h('option', { value: 'auto' }, text.levelsAuto),
    h('option', { value: 'levels' }, text.levelsCount),
    h('option', { value: 'lengths' }, text.levelsLengths),
  );
  const levels = h('input', { type: 'number', min: '1', max: '24', value: String(shape.levels.length) });
  const voices = h('input', { type: 'number', min: '1', max: '8', value: '1' });
  const lengths = h('input', {
    type: 'text',
    value: shape.levels.map((l) => formatNumber(l.sigma).replace('−', '-')).join(', '),
  });
  const counts = h(
    'div',
    {},
    h('label', { class: 'field' }, h('span', {}, text.levelsHowMany), levels),
    h('label', { class: 'field' }, h('span', {}, text.voices), voices),
  );
  const widths = h('label', { class: 'field' }, h('span', {}, text.lengthsHint), lengths);
  const show = () => {
    counts.hidden = how.value !== 'levels';
    widths.hidden = how.value !== 'lengths';
  };
  show();
  const box = dialog(
    text.levels,
    h('p', {}, text.levelsNote),
    h('label', { class: 'field' }, h('span', {}, text.levelsHow), how),
    counts,
    widths,
    h(
      'div',
      { class: 'actions' },
      h(
        'button',
        {
          type: 'button',
          class: 'primary',
          onclick: () => {
            const what =
              how.value === 'auto'
                ? {}
                : how.value === 'levels'
                  ? {
                      levels: levels.valueAsNumber,
                      ...(voices.valueAsNumber > 1 ? { voices: voices.valueAsNumber } : {}),
                    }
                  : {
                      lengths: lengths.value
                        .split(/[,;]/)
                        .map(parseLength)
                        .filter((l) => l !== ''),
                    };
            box.close();
            studio.session.setLevels(what).catch((e: Error) => studio.showMessage(e.message, 'error'));
          },
        },
        text.apply,
      ),
    ),
  );
}

function parseLength(word: string): number | string {
  const t = word.trim();
  return t === '' || t.endsWith('%') ? t : Number(t);
}
