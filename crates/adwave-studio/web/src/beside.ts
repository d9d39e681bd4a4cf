/** Two open shapes side by side with one camera, and the distances between them. */

import { h, iconButton } from './dom';
import { formatNumber } from './lengths';
import { type Deviation, facesPointInward, type Shape } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** Value of the list of colors for the distances. */
export const DEVIATION = 'deviation';

/** Distances of the vertices of both shapes from the other one. */
export interface Deviations {
  own: Float32Array;
  other: Float32Array;
  about: Deviation;
}

export class Beside {
  /** The other shape; `null` if only one is shown. */
  other: Shape | null = null;
  private about: Deviation | null = null;
  /** Counter of what is shown; answers for an earlier one are ignored. */
  private turn = 0;

  constructor(private readonly studio: Studio) {
    studio.on('shape', () => this.end());
    studio.on('shapes', () => {
      const { other } = this;
      if (other && !studio.shapes.shapes.some((s) => s.id === other.id)) this.end();
    });
  }

  /** Shows another tab beside the present one, both colored by their distance. */
  async show(id: number): Promise<void> {
    const { studio } = this;
    const { api, view } = studio;
    const mine = studio.shape!;
    const turn = ++this.turn;
    const loaded = await studio.wait(text.besideLoading, () =>
      Promise.all([api.shape(id), api.floats(`shapes/${id}/exact`), api.indices(`shapes/${id}/triangles`)]),
    );
    if (!loaded || turn !== this.turn || studio.shape?.id !== mine.id) return;
    const [shape, positions, triangles] = loaded;
    const meanLength = shape.mean_length || shape.diagonal / 100;
    const { normals } = await studio.engine.call('normalsOf', { positions: positions.slice(), triangles });
    if (turn !== this.turn) return;
    for (let i = 0; i < positions.length; i++) positions[i]! += shape.center[i % 3]! - mine.center[i % 3]!;
    const lit = facesPointInward(shape) ? 'both' : 'front';
    view.setBeside({ positions, normals, triangles, meanLength, lit });
    this.other = shape;
    studio.emit('beside');
    studio.showColors(DEVIATION);
  }

  end(): void {
    this.turn++;
    if (!this.other) return;
    this.other = null;
    this.about = null;
    this.studio.view.setBeside(null);
    this.studio.emit('beside');
  }

  /** Measures the distances between the stored edits of both shapes. */
  async measure(): Promise<Deviations | null> {
    const { studio, other, turn } = this;
    const { api, shape } = studio;
    if (!other || !shape) return null;
    await studio.saver?.waitUntilSent();
    const both = async (signal: AbortSignal) => {
      const own = await api.deviation(shape.id, other.id, signal);
      return { own, back: await api.deviation(other.id, shape.id, signal) };
    };
    // After an edit they are measured again without a notice, which would hold up undo.
    const found = this.about
      ? await both(new AbortController().signal)
      : await studio.wait(text.measuring, both);
    if (!found || turn !== this.turn) return null;
    this.about = found.own.about;
    studio.emit('beside');
    return { own: found.own.values, other: found.back.values, about: found.own.about };
  }

  /** Creates the names of both shapes, and the figures of their distance. */
  labels(): HTMLElement {
    const { studio } = this;
    const element = h('div', { class: 'beside-labels', hidden: true });
    const update = () => {
      const { other, about } = this;
      element.hidden = other === null;
      if (!other) return;
      const figures = about
        ? text.deviationFigures(
            about.rms === null ? '–' : formatNumber(about.rms),
            about.greatest === null ? '–' : formatNumber(about.greatest),
          )
        : '';
      element.replaceChildren(
        h('span', {}, h('b', {}, studio.shape!.name), figures ? h('small', {}, figures) : null),
        h(
          'span',
          {},
          h('b', {}, other.name),
          iconButton('close', text.besideEnd, () => this.end()),
        ),
      );
    };
    studio.on('beside', update);
    return element;
  }

  /** Creates the section of the tools that chooses the other shape; `close` closes the surrounding dialog. */
  section(close: () => void): Node[] {
    const { studio } = this;
    const others = studio.shapes.shapes.filter((s) => s.id !== studio.shape?.id);
    const button = (label: string, onclick: () => void) =>
      h(
        'button',
        {
          type: 'button',
          onclick: () => {
            close();
            onclick();
          },
        },
        label,
      );
    return [
      h('h3', {}, text.beside),
      h('p', {}, others.length > 0 ? text.besideNote : text.besideNone),
      h(
        'div',
        { class: 'row' },
        ...others.map((s) =>
          button(s.name, () => {
            this.show(s.id).catch((e: Error) => studio.showMessage(e.message, 'error'));
          }),
        ),
        this.other ? button(text.besideEnd, () => this.end()) : null,
      ),
    ];
  }
}
