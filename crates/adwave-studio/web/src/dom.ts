/** Helpers that build HTML elements. */

type Props = Record<string, unknown>;
type Child = Node | string | null | undefined | false;

/** Creates an element: `on…` are listeners; `class`, `aria-…`, `data-…` and unknown names are attributes. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  props: Props = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (value === undefined || value === null) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value as EventListener);
    else if (name !== 'class' && name in element && !name.includes('-') && name !== 'list') {
      (element as unknown as Props)[name] = value;
    } else if (value !== false)
      element.setAttribute(name === 'class' ? 'class' : name, value === true ? '' : String(value));
  }
  element.append(...children.filter((c): c is Node | string => c !== null && c !== undefined && c !== false));
  return element;
}

/** SVG paths of the icons on a 16 × 16 grid. */
const ICONS = {
  undo: 'M6 3 2.5 6.5 6 10 M3 6.5h6.5a4 4 0 0 1 0 8H6',
  redo: 'M10 3l3.5 3.5L10 10 M13 6.5H6.5a4 4 0 0 0 0 8H10',
  eye: 'M1.5 8S4 3.5 8 3.5 14.5 8 14.5 8 12 12.5 8 12.5 1.5 8 1.5 8Z M8 6.2a1.8 1.8 0 1 1 0 3.6 1.8 1.8 0 0 1 0-3.6Z',
  off: 'M2 2l12 12 M4 5C2.400 6.300 1.500 8 1.500 8S4 12.500 8 12.500c1 0 2-.3 2.800-.7 M6.500 3.700c.5-.1 1-.2 1.500-.2 4 0 6.500 4.500 6.500 4.500s-.6 1.100-1.700 2.200',
  copy: 'M5.500 5.500h8v8h-8Z M10.500 5.500v-3h-8v8h3',
  bin: 'M2.500 4.500h11 M6 4.500v-2h4v2 M4 4.500l.7 9h6.600l.7-9 M6.700 7v4 M9.300 7v4',
  plus: 'M8 3v10 M3 8h10',
  split: 'M8 1.500v13 M2.500 4h3v8h-3 M10.500 4h3v8h-3',
  theme: 'M8 2a6 6 0 1 0 0 12Z M8 2a6 6 0 0 1 0 12',
  help: 'M5.800 6a2.200 2.200 0 1 1 3.300 1.900c-.7.4-1.100.9-1.100 1.600v.3 M8 12.200v.3',
  invert: 'M2.500 2.500h11v11h-11Z M2.500 13.500l11-11 M6 13.500 13.500 6 M9.500 13.500l4-4',
  frame: 'M2.500 5.500v-3h3 M10.500 2.500h3v3 M13.500 10.500v3h-3 M5.500 13.500h-3v-3',
  before: 'M8 4.500V8l2.500 1.500 M3 5.200A5.700 5.700 0 1 1 2.400 9 M2.500 2.500v3h3',
  close: 'M4 4l8 8 M12 4l-8 8',
  turn: 'M13.500 8A5.500 5.500 0 1 1 11.500 3.700 M13.500 2v3.500H10',
  brush:
    'M8.500 7.500 13.500 2.500 M8.500 7.500c-1.500-.8-3 0-3.500 1.500-.5 1.800-.8 3-2.500 4 2.500 1 6.500.7 7.300-2.300.3-1.300-.2-2.500-1.300-3.200Z',
  hand: 'M5 9V4.500a1 1 0 0 1 2 0V8 M7 7.500v-4a1 1 0 0 1 2 0v4 M9 7.500v-3a1 1 0 0 1 2 0V8 M11 7.500V6a1 1 0 0 1 2 0v4c0 2.500-1.500 4-4 4H8c-1.500 0-2.500-.7-3.300-2L3 9.300c-.7-1.200.9-2 1.600-1L5 9',
  up: 'M4 9.500 8 5.500l4 4',
  down: 'M4 6.500l4 4 4-4',
  play: 'M5 3.500v9l7-4.500Z',
} as const;

export type IconName = keyof typeof ICONS;

export function icon(name: IconName): SVGSVGElement {
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  svg.setAttribute('viewBox', '0 0 16 16');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS(space, 'path');
  path.setAttribute('d', ICONS[name]);
  svg.append(path);
  return svg;
}

/** Creates an icon button; the label is its accessible name and tooltip. */
export function iconButton(
  name: IconName,
  label: string,
  onclick: () => void,
  props: Props = {},
): HTMLButtonElement {
  return h(
    'button',
    { type: 'button', class: 'icon', 'aria-label': label, title: label, onclick, ...props },
    icon(name),
  );
}

/** Creates a segmented control; with the value `null` nothing is chosen. */
export function segments<T extends string>(
  label: string,
  choices: readonly (readonly [T, string])[],
  value: T | null,
  choose: (value: T) => void,
): HTMLElement & { set(value: T | null): void } {
  const buttons = choices.map(([key, name]) =>
    h('button', { type: 'button', 'aria-pressed': String(key === value), onclick: () => choose(key) }, name),
  );
  const group = h('div', { class: 'segments', role: 'group', 'aria-label': label }, ...buttons);
  return Object.assign(group, {
    set(next: T | null) {
      for (const [i, b] of buttons.entries()) b.setAttribute('aria-pressed', String(choices[i]![0] === next));
    },
  });
}

/** Creates a horizontal slider with its label and value. */
export function slider(
  label: string,
  range: { min: number; max: number; step: number; value: number },
  show: (value: number) => string,
  onMove: (value: number, done: boolean) => void,
): HTMLElement & { set(value: number): void } {
  const number = h('output', {}, show(range.value));
  const input = h('input', {
    type: 'range',
    min: String(range.min),
    max: String(range.max),
    step: String(range.step),
    'aria-label': label,
  });
  input.value = String(range.value);
  const tell = (done: boolean) => {
    const value = input.valueAsNumber;
    number.textContent = show(value);
    input.setAttribute('aria-valuetext', show(value));
    onMove(value, done);
  };
  input.addEventListener('input', () => tell(false));
  input.addEventListener('change', () => tell(true));
  const row = h('label', { class: 'slider' }, h('span', {}, label), number, input);
  return Object.assign(row, {
    set(value: number) {
      input.value = String(value);
      number.textContent = show(value);
    },
  });
}

export function select<T extends string>(
  label: string,
  choices: readonly (readonly [T, string])[],
  value: T,
  choose: (value: T) => void,
): HTMLLabelElement {
  const element = h(
    'select',
    { 'aria-label': label, onchange: () => choose(element.value as T) },
    ...choices.map(([key, name]) => h('option', { value: key }, name)),
  );
  element.value = value;
  return h('label', { class: 'field' }, h('span', {}, label), element);
}

/** Creates a labeled check box. */
export function check(label: string, checked: boolean, set: (on: boolean) => void): HTMLLabelElement {
  const box = h('input', { type: 'checkbox', checked, onchange: () => set(box.checked) });
  return h('label', { class: 'check' }, box, h('span', {}, label));
}

/** Downloads a blob as a file. */
export function download(blob: Blob, name: string): void {
  const url = URL.createObjectURL(blob);
  const a = h('a', { href: url, download: name });
  document.body.append(a);
  a.click();
  a.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** Opens the file chooser of the browser. */
export function chooseFile(accept: string, chosen: (file: File) => void): void {
  const input = h('input', { type: 'file', accept, hidden: true });
  input.addEventListener('change', () => {
    const file = input.files?.[0];
    if (file) chosen(file);
    input.remove();
  });
  document.body.append(input);
  input.click();
}
