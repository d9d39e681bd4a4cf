/** Tools: comparison with other methods, report and denoising. */

import { dialog } from './dialog';
import { h } from './dom';
import type { Files } from './files';
import { formatNumber } from './lengths';
import type { CompareMethod, Comparison, Shape } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** Another method shown beside the edit. */
export interface ShownComparison {
  method: CompareMethod | 'noisy';
  /** Figures of another method; `null` for the shape before denoising. */
  about: Comparison | null;
}

function button(label: string, onclick: () => void): HTMLButtonElement {
  return h('button', { type: 'button', onclick }, label);
}

/** Creates the sections of the tools; `close` closes the surrounding dialog. */
export function toolSections(studio: Studio, files: Files, close: () => void): Node[] {
  const shape = studio.shape!;
  const strength = h('input', {
    type: 'number',
    min: '0.1',
    max: '10',
    step: '0.1',
    value: '1',
    'aria-label': text.strength,
  });
  /** Closes the dialog, shows a message, and runs a tool after the edit is saved. */
  const work = (label: string, what: (isCancelled: () => boolean) => Promise<void>) => {
    close();
    void files.reportErrors(async () => {
      await studio.saver?.waitUntilSent();
      await studio.wait(`${label}…`, (signal) => what(() => signal.aborted));
    });
  };
  const compare = (method: CompareMethod) =>
    work(text.compare, (isCancelled) => showComparison(studio, method, isCancelled));
  const compared = [
    ...studio.beside.section(close),
    h('h3', {}, text.compare),
    h('p', {}, text.compareNote),
    h(
      'div',
      { class: 'row' },
      button(text.compareMethods.taubin, () => compare('taubin')),
      button(text.compareMethods.harmonics, () => compare('harmonics')),
      studio.comparison
        ? button(text.compareEnd, () => {
            endComparison(studio);
            close();
          })
        : null!,
    ),
  ];
  const reported = [
    h('h3', {}, text.report),
    h('p', {}, text.reportNote),
    h(
      'div',
      { class: 'row' },
      button(text.reportGo, () =>
        work(text.report, async (isCancelled) => {
          const { path } = await studio.api.report(shape.id);
          if (isCancelled()) return;
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
  ];
  const denoised = [
    h('h3', {}, text.denoise),
    h('p', {}, text.denoiseNote),
    h(
      'div',
      { class: 'row' },
      h('label', { class: 'field' }, h('span', {}, text.strength), strength),
      button(text.denoiseGo, () =>
        work(text.denoise, async (isCancelled) => {
          const before = (await studio.engine.call('positions', {})).positions;
          const made = await studio.api.denoise(shape.id, strength.valueAsNumber || 1);
          if (isCancelled()) {
            await studio.api.close(made.id);
            return;
          }
          await files.refreshShapes();
          await files.showShape(made.id);
          await showNoisy(studio, made.id, shape, before);
          studio.showMessage(text.denoised(made.noise));
        }),
      ),
    ),
  ];
  // A graph has no surface to compare, and only a curve has positions with noise.
  const isCurve = shape.kind === 'curve';
  const sections = shape.graph
    ? [...reported, ...(isCurve ? denoised : [])]
    : [...compared, ...reported, ...denoised];
  return sections.filter((node) => node !== null);
}

/** Shows the positions before denoising on the left of the wipe. */
async function showNoisy(studio: Studio, id: number, noisy: Shape, before: Float32Array): Promise<void> {
  if (studio.shape?.id !== id) return;
  const { center } = studio.shape;
  for (let i = 0; i < before.length; i++) before[i]! += noisy.center[i % 3]! - center[i % 3]!;
  const { normals } = await studio.engine.call('normals', { positions: before.slice() });
  studio.view.arrays.setComparison(before, normals);
  studio.comparison = { method: 'noisy', about: null };
  studio.emit('compared');
}

async function showComparison(
  studio: Studio,
  method: CompareMethod,
  isCancelled: () => boolean,
): Promise<void> {
  const { id } = studio.shape!;
  const { positions, about } = await studio.api.compare(id, method);
  if (studio.shape?.id !== id || isCancelled()) return;
  const { normals } = await studio.engine.call('normals', { positions });
  studio.view.arrays.setComparison(positions, normals);
  studio.comparison = { method, about };
  studio.emit('compared');
}

export function endComparison(studio: Studio): void {
  studio.view.arrays.setComparison(null, null);
  studio.comparison = null;
  studio.emit('compared');
}

/** Creates the panel with the figures of a comparison and a button to end it. */
export function comparisonPanel(studio: Studio): HTMLElement {
  const panel = h('aside', { class: 'comparison', hidden: true, 'aria-label': text.compare });
  const show = () => {
    const { comparison } = studio;
    panel.hidden = comparison === null;
    if (!comparison) return;
    const { about, method } = comparison;
    if (!about) {
      panel.replaceChildren(
        h('p', { class: 'hint' }, text.noisyHint),
        button(text.compareEnd, () => endComparison(studio)),
      );
      return;
    }
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
          row(text.roughness, formatNumber(about.roughness.edit), formatNumber(about.roughness.other)),
          row(text.rms, formatNumber(about.rms.edit), formatNumber(about.rms.other)),
        ),
      ),
      h('p', { class: 'hint' }, describeStrength(about)),
      button(text.compareEnd, () => endComparison(studio)),
    );
  };
  studio.on('compared', show);
  return panel;
}

function describeStrength({ how }: Comparison): string {
  return 'degree' in how
    ? text.howTaubin(how.degree, formatNumber(how.frequency))
    : text.howHarmonics(how.harmonics, formatNumber(how.t));
}
