/** The picture as a PNG, with the legend of its colors. */

/** Creates a PNG of the canvas; a visible legend is drawn into its corner, as on the page. */
export function pictureWithLegend(canvas: HTMLCanvasElement, legend: HTMLElement | null): Promise<Blob> {
  const copy = document.createElement('canvas');
  copy.width = canvas.width;
  copy.height = canvas.height;
  const context = copy.getContext('2d')!;
  context.drawImage(canvas, 0, 0);
  if (legend && !legend.hidden) drawLegend(context, canvas, legend);
  return new Promise((done, failed) => {
    copy.toBlob(
      (blob) => (blob ? done(blob) : failed(new Error('The picture could not be created.'))),
      'image/png',
    );
  });
}

/** The legend as a layer of a picture of another size, at the same corner and in the same share of its height. */
export function legendLayer(
  canvas: HTMLCanvasElement,
  legend: HTMLElement,
  size: { width: number; height: number },
): { image: ImageData; x: number; y: number } {
  const frame = canvas.getBoundingClientRect();
  const box = legend.getBoundingClientRect();
  const scale = size.height / frame.height;
  const layer = document.createElement('canvas');
  layer.width = Math.max(1, Math.ceil((box.width + 2) * scale));
  layer.height = Math.max(1, Math.ceil((box.height + 2) * scale));
  const context = layer.getContext('2d')!;
  // The border has half of its width outside.
  const corner = { left: box.left - 1, top: box.top - 1 };
  drawLegendAt(context, corner, scale, legend);
  const right = frame.right - box.right;
  const left = box.left - frame.left;
  const x = left <= right ? (left - 1) * scale : size.width - layer.width - (right - 1) * scale;
  const y = (box.top - 1 - frame.top) * scale;
  return { image: context.getImageData(0, 0, layer.width, layer.height), x: Math.round(x), y: Math.round(y) };
}

/** Draws the panel, its color bar or swatches, and all its texts at their places. */
function drawLegend(context: CanvasRenderingContext2D, canvas: HTMLCanvasElement, legend: HTMLElement): void {
  const frame = canvas.getBoundingClientRect();
  drawLegendAt(context, frame, canvas.width / frame.width, legend);
}

/** Draws the panel in a context with this corner and so many pixels for one of the page. */
function drawLegendAt(
  context: CanvasRenderingContext2D,
  frame: { left: number; top: number },
  scale: number,
  legend: HTMLElement,
): void {
  context.scale(scale, scale);
  const place = (element: Element) => {
    const r = element.getBoundingClientRect();
    return { x: r.left - frame.left, y: r.top - frame.top, width: r.width, height: r.height };
  };
  const box = place(legend);
  const style = getComputedStyle(legend);
  context.fillStyle = style.backgroundColor;
  context.strokeStyle = style.borderTopColor;
  context.fillRect(box.x, box.y, box.width, box.height);
  context.strokeRect(box.x, box.y, box.width, box.height);
  for (const bar of legend.querySelectorAll('canvas')) {
    const at = place(bar);
    if (at.width > 0) context.drawImage(bar, at.x, at.y, at.width, at.height);
  }
  context.textBaseline = 'middle';
  for (const element of legend.querySelectorAll<HTMLElement>('span, li, i')) {
    const at = place(element);
    const look = getComputedStyle(element);
    if (at.width === 0) continue;
    if (element.tagName === 'I') {
      context.fillStyle = look.backgroundColor;
      context.fillRect(at.x, at.y, at.width, at.height);
      continue;
    }
    context.fillStyle = look.color;
    context.font = look.font;
    const indent = element.querySelector('i') ? 16 : 0;
    context.fillText(
      element.textContent ?? '',
      at.x + indent,
      at.y + at.height / 2,
      // A longer text is condensed.
      Math.max(1, at.width - indent),
    );
  }
}
