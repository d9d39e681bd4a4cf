/** The parts of a mesh whose faces point inward, or are turned by the edit, with a switch for each. */

import { check, h, iconButton } from './dom';
import { formatCount } from './lengths';
import type { Studio } from './studio';
import { text } from './text';
import { stillInward } from './turned-parts';

/** Largest number of parts that are listed one by one. */
const MOST = 30;

interface ListedPart {
  vertex: number;
  nFaces: number | null;
}

/** Lists the parts that point inward, the largest first, and then those that were turned although they did not. */
function listedParts(studio: Studio): ListedPart[] {
  const inward = studio.shape?.inward ?? [];
  const others = studio.doc.turned.filter((vertex) => !inward.some((part) => part.vertex === vertex));
  return [
    ...inward.map((part) => ({ vertex: part.vertex, nFaces: part.n_faces })),
    ...others.map((vertex) => ({ vertex, nFaces: null })),
  ];
}

/** Creates the switches; they are hidden for shapes without such parts. */
export function facesControls(studio: Studio): HTMLElement {
  const element = h('div', { class: 'faces', role: 'group', 'aria-label': text.faces });
  const row = ({ vertex, nFaces }: ListedPart, isOnly: boolean) => {
    const isTurned = studio.doc.turned.includes(vertex);
    const label = isOnly
      ? text.turnOnly
      : text.turnPart(vertex, nFaces === null ? null : formatCount(nFaces));
    const box = check(label, isTurned, (on) => studio.turnedParts.set([vertex], on));
    if (isOnly) return box;
    const find = iconButton('frame', text.showPart(vertex), () => {
      studio.view.showMark(studio.view.arrays.place(vertex));
    });
    return h('div', { class: 'row part' }, box, find);
  };
  const rebuild = () => {
    const parts = studio.shape && !studio.isGrid ? listedParts(studio) : [];
    element.hidden = parts.length === 0;
    if (parts.length === 0) {
      element.replaceChildren();
      return;
    }
    const rest = stillInward(studio.shape!, studio.doc.turned);
    const isOnly = parts.length === 1 && studio.shape!.components === 1;
    element.replaceChildren(
      ...parts.slice(0, MOST).map((part) => row(part, isOnly)),
      ...(parts.length > MOST ? [h('p', { class: 'hint' }, text.moreParts(parts.length - MOST))] : []),
      ...(parts.length > 1
        ? [
            h(
              'button',
              {
                type: 'button',
                disabled: rest.length === 0,
                onclick: () => studio.turnedParts.set(rest, true),
              },
              text.turnAll,
            ),
          ]
        : []),
    );
  };
  let shown: readonly number[] | null = null;
  studio.on('shape', rebuild);
  studio.on('doc', () => {
    if (studio.doc.turned !== shown) rebuild();
    shown = studio.doc.turned;
  });
  return element;
}

/** Creates the button that turns over the part of a vertex, or back. */
export function turnPartButton(studio: Studio, vertex: number): HTMLElement {
  const turn = async () => {
    try {
      const part = await studio.turnedParts.partAt(vertex);
      if (part !== null) studio.turnedParts.set([part], !studio.doc.turned.includes(part));
    } catch (error) {
      studio.showMessage((error as Error).message, 'error');
    }
  };
  return h('button', { type: 'button', onclick: () => void turn() }, text.turnPartHere);
}
