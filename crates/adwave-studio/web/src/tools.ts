/** Other commands as panels: denoise, compare with other methods, report, the page in one file. */

import { dialog } from './dialog';
import { h } from './dom';
import type { Files } from './files';
import { short } from './lengths';
import type { CompareMethod, Comparison } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** A shape by another method, beside the edit. */
export interface Compared {
  method: CompareMethod;
  about: Comparison;
}

function button(label: string, onclick: () => void): HTMLButtonElement {
  return h('button', { type: 'button', onclick }, label);
}

/** The sections of the tools; `close` closes the dialog that they are in. */
export function tools(studio: Studio, files: Files, close: () => void): Node[] {
  const shape = studio.shape!;
  const strength = h('input', {
    type: 'number',
    min: '0.1',
    max: '10',
    step: '0.1',
    value: '1',
    'aria-label': text.strength,
  });
  /** Closes the dialog, says that it takes a while, and does it with the edit kept by the server. */
  const work = (what: () => Promise<void>) => {
    close();
    studio.say(text.working);
    void files.try(async () => {
      await studio.saver?.sent();
      await what();
    });
  };
  const compare = (method: CompareMethod) => work(() => showComparison(studio, method));
  return [
    h('h3', {}, text.compare),
    h('p', {}, text.compareNote),
    h(
      'div',
      { class: 'row' },
      button(text.compareMethods.taubin, () => compare('taubin')),
      button(text.compareMethods.harmonics, () => compare('harmonics')),
      studio.compared
        ? button(text.compareEnd, () => {
            endComparison(studio);
            close();
          })
        : null!,
    ),
    h('h3', {}, text.report),
    h('p', {}, text.reportNote),
    h(
      'div',
      { class: 'row' },
      button(text.reportGo, () =>
        work(async () => {
          const { path } = await studio.api.report(shape.id);
          const href = new URL(path, studio.api.root).href;
          dialog(
            text.report,
            h('p', {}, text.reportReady),
            h(
              'p',
              {},
              h('a', { href, target: '_blank', rel: 'noopener', class: 'primary' }, text.reportOpen),
            ),
          );
        }),
      ),
    ),
    h('h3', {}, text.denoise),
    h('p', {}, text.denoiseNote),
    h(
      'div',
      { class: 'row' },
      strength,
      button(text.denoiseGo, () =>
        work(async () => {
          const made = await studio.api.denoise(shape.id, strength.valueAsNumber || 1);
          await files.list();
          await files.go(made.id);
          studio.say(text.denoised(made.noise));
        }),
      ),
    ),
  ].filter((node) => node !== null);
}

async function showComparison(studio: Studio, method: CompareMethod): Promise<void> {
  const { id } = studio.shape!;
  const { positions, about } = await studio.api.compare(id, method);
  if (studio.shape?.id !== id) return;
  const { normals } = await studio.engine.call('normals', { positions });
  studio.view.arrays.setOther(positions, normals);
  studio.compared = { method, about };
  studio.emit('compared');
}

export function endComparison(studio: Studio): void {
  studio.view.arrays.setOther(null, null);
  studio.compared = null;
  studio.emit('compared');
}

/** What is beside the edit, with its numbers and a way to end it. */
export function comparisonPanel(studio: Studio): HTMLElement {
  const panel = h('aside', { class: 'comparison', hidden: true, 'aria-label': text.compare });
  const show = () => {
    const { compared } = studio;
    panel.hidden = compared === null;
    if (!compared) return;
    const { about, method } = compared;
    const row = (name: string, edit: string, other: string) =>
      h('tr', {}, h('th', { scope: 'row' }, name), h('td', {}, edit), h('td', {}, other));
    panel.replaceChildren(
      h(
        'table',
        {},
        h(
          'thead',
          {},
          h(
            'tr',
            {},
            h('td', {}),
            h('th', { scope: 'col' }, text.thisEdit),
            h('th', { scope: 'col' }, text.compareShort[method]),
          ),
        ),
        h(
          'tbody',
          {},
          row(text.roughness, short(about.roughness.edit), short(about.roughness.other)),
          row(text.rms, short(about.rms.edit), short(about.rms.other)),
        ),
      ),
      h('p', { class: 'hint' }, how(about)),
      button(text.compareEnd, () => endComparison(studio)),
    );
  };
  studio.on('compared', show);
  return panel;
}

function how({ how }: Comparison): string {
  return 'degree' in how
    ? text.howTaubin(how.degree, short(how.frequency))
    : text.howHarmonics(how.harmonics, short(how.t));
}
