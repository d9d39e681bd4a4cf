/** Dialog that chooses the bands: automatic, by number with bands per octave, or by widths. */

import { dialog } from './dialog';
import { h } from './dom';
import { formatNumber, toModelUnits } from './lengths';
import type { LevelsChoice } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** Largest number of dyadic bands, and of bands per octave, that the dialog accepts. */
const MOST = { count: 24, voices: 8 };

export type Choice = 'auto' | 'count' | 'lengths';

/** Checks the input of the dialog; returns the request, or a sentence about the problem. */
export function parseChoice(
  how: Choice,
  input: { count: string; voices: string; lengths: string },
  diagonal: number,
): LevelsChoice | string {
  const whole = (word: string, most: number) => {
    const n = Number(word);
    return word.trim() !== '' && Number.isInteger(n) && n >= 1 && n <= most ? n : null;
  };
  if (how === 'auto') return {};
  if (how === 'count') {
    const levels = whole(input.count, MOST.count);
    if (levels === null) return text.badCount(MOST.count);
    const voices = whole(input.voices, MOST.voices);
    if (voices === null) return text.badVoices(MOST.voices);
    return voices > 1 ? { levels, voices } : { levels };
  }
  const words = input.lengths
    .split(/[,;\s]+/)
    .map((word) => word.replace('−', '-'))
    .filter((word) => word !== '');
  const wrong = words.find((word) => !(toModelUnits(word, diagonal) > 0 && /^[\d.e+-]+%?$/i.test(word)));
  if (wrong !== undefined) return text.badWidth(wrong);
  const sizes = words.map((word) => toModelUnits(word, diagonal));
  if (sizes.length === 0 || sizes.some((size, j) => j > 0 && size <= sizes[j - 1]!)) return text.badLengths;
  return { lengths: words.map((word) => (word.endsWith('%') ? word : Number(word))) };
}

export function openLevels(studio: Studio): void {
  const { shape } = studio;
  if (!shape) return;
  const how = h(
    'select',
    { 'aria-label': text.levelsHow, onchange: () => show() },
    h('option', { value: 'auto' }, text.levelsAuto),
    h('option', { value: 'count' }, text.levelsCount),
    h('option', { value: 'lengths' }, text.levelsLengths),
  );
  const { choice } = shape;
  const count = h('input', {
    type: 'number',
    min: '1',
    max: String(MOST.count),
    value: String(Math.min(MOST.count, choice.levels ?? shape.levels.length)),
  });
  const voices = h('input', { type: 'number', min: '1', max: String(MOST.voices), value: '1' });
  const lengths = h('input', {
    type: 'text',
    value: shape.levels.map((l) => formatNumber(l.sigma).replace('−', '-')).join(', '),
  });
  const counts = h(
    'div',
    { class: 'stack' },
    h('label', { class: 'field' }, h('span', {}, text.levelsHowMany), count),
    h('label', { class: 'field' }, h('span', {}, text.voices), voices),
  );
  const widths = h('label', { class: 'stack' }, h('span', {}, text.lengthsHint), lengths);
  const problem = h('p', { class: 'problem', role: 'alert', hidden: true });
  const show = () => {
    counts.hidden = how.value !== 'count';
    widths.hidden = how.value !== 'lengths';
    problem.hidden = true;
  };
  show();
  const complain = (sentence: string) => {
    problem.textContent = sentence;
    problem.hidden = false;
  };
  const apply = async () => {
    const input = { count: count.value, voices: voices.value, lengths: lengths.value };
    const what = parseChoice(how.value as Choice, input, shape.diagonal);
    if (typeof what === 'string') {
      complain(what);
      return;
    }
    box.close();
    try {
      await studio.session.setLevels(what);
    } catch (error) {
      // The input is shown again beside the reason.
      document.body.append(box);
      box.showModal();
      complain((error as Error).message);
    }
  };
  const box = dialog(
    text.levels,
    h('p', {}, text.levelsNote),
    h('label', { class: 'field' }, h('span', {}, text.levelsHow), how),
    counts,
    widths,
    problem,
    h(
      'div',
      { class: 'actions' },
      h('button', { type: 'button', class: 'primary', onclick: () => void apply() }, text.apply),
    ),
  );
}
