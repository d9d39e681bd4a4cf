/** Script of the exported file: the shape with one slider per band, without a server. */

import { neighborsOfCloud } from '../compute/adjacency';
import { cloudNormals, meshNormals } from '../compute/normals';
import { editedPositions } from '../compute/positions';
import { h } from '../dom';
import { gainOf, gainText, positionOf, SLIDER_MAX } from '../gain';
import { formatCount, formatNumber } from '../lengths';
import { viewerText as text } from '../text';
import { unpack, type ViewerContent } from './content';
import { Picture } from './picture';

/** Dragging and arrow keys rotate; the wheel and pinching zoom. */
function enableGestures(canvas: HTMLCanvasElement, picture: Picture, redraw: () => void): void {
  const pointers = new Map<number, { x: number; y: number }>();
  const turn = (dx: number, dy: number) => {
    picture.yaw += dx * 0.008;
    picture.pitch = Math.max(-1.55, Math.min(1.55, picture.pitch + dy * 0.008));
    redraw();
  };
  const zoom = (factor: number) => {
    picture.distance = Math.max(0.15, Math.min(6, picture.distance * factor));
    redraw();
  };
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };
  canvas.addEventListener('pointerdown', (e) => {
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
  });
  canvas.addEventListener('pointermove', (e) => {
    const last = pointers.get(e.pointerId);
    if (!last) return;
    const before = spread();
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    const now = spread();
    if (before > 0 && now > 0) zoom(before / now);
    else turn(e.clientX - last.x, e.clientY - last.y);
  });
  for (const end of ['pointerup', 'pointercancel'] as const) {
    canvas.addEventListener(end, (e) => pointers.delete(e.pointerId));
  }
  canvas.addEventListener(
    'wheel',
    (e) => {
      e.preventDefault();
      zoom(Math.exp(e.deltaY * 0.001));
    },
    { passive: false },
  );
  canvas.addEventListener('keydown', (e) => {
    const by = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] }[e.key];
    if (by) turn(by[0]!, by[1]!);
    else if (e.key === '+' || e.key === '=') zoom(0.87);
    else if (e.key === '-') zoom(1.15);
    else return;
    e.preventDefault();
  });
}

async function start(): Promise<void> {
  const app = document.getElementById('viewer')!;
  const canvas = h('canvas', { tabIndex: 0, 'aria-label': text.stage });
  let content: ViewerContent;
  try {
    content = await unpack(document.getElementById('shape')!.textContent!);
  } catch {
    app.replaceChildren(h('p', { class: 'fatal', role: 'alert' }, text.broken));
    return;
  }
  const { head, positions, triangles, bands, masks } = content;
  app.append(canvas);
  let picture: Picture;
  try {
    picture = new Picture(canvas, head.n_vertices, triangles);
  } catch {
    app.replaceChildren(h('p', { class: 'fatal', role: 'alert' }, text.noWebgl));
    return;
  }
  picture.frame(positions);
  if (head.layers.length === 0) {
    head.layers.push({ name: '', opacity: 1, gains: head.levels.map(() => 1), mask: null });
  }
  const edited = new Float32Array(positions.length);
  const sums = new Float32Array(positions.length);
  const normals = new Int8Array(4 * head.n_vertices);
  if (triangles.length === 0) {
    const { offsets, entries } = neighborsOfCloud(positions, 8);
    cloudNormals(positions, offsets, entries, normals);
  }
  let before = false;
  let frame = 0;
  let stale = true;

  function draw(): void {
    frame = 0;
    if (stale) {
      const terms = head.layers.map((l) => ({ ...l, mask: l.mask === null ? null : masks[l.mask]! }));
      editedPositions(positions, bands, before ? [] : terms, edited);
      if (triangles.length) meshNormals(edited, triangles, sums, normals);
      picture.show(edited, normals);
      stale = false;
    }
    const [r, g, b] = getComputedStyle(app)
      .backgroundColor.match(/\d+/g)!
      .map((x) => Number(x) / 255);
    picture.draw([r!, g!, b!]);
  }
  const request = (changed: boolean) => {
    stale ||= changed;
    if (frame === 0) frame = requestAnimationFrame(draw);
  };

  // Sliders of one layer, initially of one that has an effect.
  let layer = Math.max(
    0,
    head.layers.findIndex((l) => l.gains.some((g) => g !== 1)),
  );
  const sliders = head.levels.map(({ level, sigma }, j) => {
    const name = text.band(level, formatNumber(sigma));
    const number = h('output', {});
    const input = h('input', {
      type: 'range',
      min: '0',
      max: String(SLIDER_MAX),
      step: '1',
      'aria-label': name,
    });
    const set = () => {
      const gain = head.layers[layer]!.gains[j]!;
      input.value = String(positionOf(gain));
      number.textContent = gainText(gain);
    };
    input.addEventListener('input', () => {
      const { gains } = head.layers[layer]!;
      gains[j] = gainOf(input.valueAsNumber);
      number.textContent = gainText(gains[j]);
      request(true);
    });
    return { row: h('label', {}, h('span', {}, `σ ${formatNumber(sigma)}`), input, number), set };
  });
  const show = () => {
    for (const { set } of sliders) set();
  };
  const chooser = h(
    'select',
    {
      'aria-label': text.layer,
      onchange: () => {
        layer = chooser.selectedIndex;
        show();
      },
    },
    ...head.layers.map((l, i) => h('option', {}, l.name || text.layerName(i + 1))),
  );
  chooser.selectedIndex = layer;
  const first = head.layers.map((l) => [...l.gains]);
  const button = (label: string, onclick: () => void) => h('button', { type: 'button', onclick }, label);
  const setAll = (gains: (i: number) => number[]) => {
    for (const [i, l] of head.layers.entries()) l.gains = [...gains(i)];
    show();
    request(true);
  };
  const compare = button(text.before, () => {
    before = !before;
    compare.setAttribute('aria-pressed', String(before));
    request(true);
  });
  compare.setAttribute('aria-pressed', 'false');
  const notes = [
    text.made(formatCount(head.n_vertices)),
    head.n_vertices < head.n_vertices_before ? text.decimated(formatCount(head.n_vertices_before)) : '',
    head.rules ? text.rules : '',
  ];
  app.append(
    h(
      'aside',
      {},
      h('h1', {}, head.name),
      head.layers.length > 1 ? chooser : null,
      h('div', { class: 'bands' }, ...sliders.map((s) => s.row)),
      h(
        'div',
        { class: 'row' },
        button(text.edit, () => setAll((i) => first[i]!)),
        button(text.neutral, () => setAll((i) => first[i]!.map(() => 1))),
        compare,
      ),
      ...notes.filter((n) => n).map((n) => h('p', {}, n)),
      h('details', {}, h('summary', {}, text.about), h('p', {}, text.license)),
    ),
  );
  show();

  enableGestures(canvas, picture, () => request(false));
  new ResizeObserver(() => request(false)).observe(canvas);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => request(false));
  draw();
}

void start();
