/** Opening, saving and downloading files, and the tabs of open shapes. */

import { ApiError } from './api';
import type { fetchShape as FetchShape } from './boot';
import { dialog } from './dialog';
import { check, chooseFile, download, h, iconButton } from './dom';
import { framesOf } from './frames';
import { PaperPictures } from './paper/dialog';
import { pictureWithLegend } from './picture';
import type { Edit, ReadableFormat, Shape } from './protocol';
import { areNeutral, isNeutral, toEdit } from './state';
import type { Studio } from './studio';
import { text } from './text';
import { toolSections } from './tools';
import { stillInward } from './turned-parts';
import { parseView } from './view-memory';

/** Files that hold values at vertices and no shape. */
const VALUES =
  /\.(npy|dmat|mgh|mgz|annot|label|thickness|curv|sulc|area|shape\.gii|func\.gii|label\.gii|d(scalar|tseries|label)\.nii)(\.gz)?$/i;

/** Largest table, in bytes, that is looked through for its number of rows. */
const MOST_OF_TABLE = 64 << 20;

/**
 * True for a table with a row for each vertex that is no list of points: its columns have other names than x and y, or the
 * shape is a graph.
 */
async function isTableOfValues(file: File, { n_vertices, graph }: Shape): Promise<boolean> {
  if (!/\.(csv|tsv|txt)$/i.test(file.name) || file.size > MOST_OF_TABLE) return false;
  const rows = (await file.text()).split('\n').filter((row) => row.trim() !== '');
  const names = (rows[0] ?? '').toLowerCase().split(/[\s,;]+/);
  const hasNames = names.some((name) => !/^([-+]?nan)?$/.test(name) && Number.isNaN(Number(name)));
  if (rows.length !== n_vertices + Number(hasNames)) return false;
  return Boolean(graph) || (hasNames && !(names.includes('x') && names.includes('y')));
}

export class Files {
  readonly pictures: PaperPictures;

  constructor(
    private readonly studio: Studio,
    private readonly fetchShape: typeof FetchShape,
  ) {
    this.pictures = new PaperPictures(studio, this);
  }

  async showShape(id: number): Promise<void> {
    try {
      const opened = this.studio.shapes.shapes.find((s) => s.id === id);
      const { domain } = opened ?? { domain: 'shape' as const };
      await this.studio.session.open(this.fetchShape(this.studio.api, { id, domain }));
    } catch (error) {
      this.studio.showMessage((error as Error).message, 'error');
    }
  }

  async refreshShapes(): Promise<void> {
    this.studio.shapes = await this.studio.api.shapes();
    this.studio.emit('shapes');
  }

  async openFile(file: File): Promise<void> {
    const { studio } = this;
    if (/\.toml$/i.test(file.name)) {
      await this.reportErrors(async () => studio.session.applyRecipe(await file.text()));
      return;
    }
    if (/\.edit\.json$/i.test(file.name)) {
      await this.reportErrors(async () => studio.session.applyEdit(JSON.parse(await file.text()) as Edit));
      return;
    }
    if (/\.picture\.json$/i.test(file.name)) {
      await this.reportErrors(async () => this.pictures.openRecipe(await file.text(), file.name));
      return;
    }
    if (/\.view\.json$/i.test(file.name)) {
      const view = parseView(await file.text());
      if (view && studio.shape) studio.shownView?.set(view);
      else studio.showMessage(text.badView(file.name), 'error');
      return;
    }
    await this.reportErrors(async () => {
      const { shape } = studio;
      if (shape && !shape.grid && (VALUES.test(file.name) || (await isTableOfValues(file, shape)))) {
        await this.addFields(file);
        return;
      }
      const opened = await this.openShape(file);
      if (!opened) return;
      await this.refreshShapes();
      await this.showShape(opened.id);
    });
  }

  /** Opens a file as a shape, or adds its values to the open shape if it has no positions. */
  private async openShape(file: File): Promise<{ id: number } | null> {
    const { studio } = this;
    try {
      return await studio.wait(text.reading(file.name), (signal) => studio.api.open(file, file.name, signal));
    } catch (error) {
      const takesFields = studio.shape && !studio.isGrid;
      if (!takesFields || !(error instanceof ApiError) || error.status !== 400) throw error;
      try {
        await this.addFields(file);
      } catch (reason) {
        // A GIFTI with values says why they do not fit; another file is no shape.
        throw /\.(gii|nii|csv|txt)(\.gz)?$/i.test(file.name) ? reason : error;
      }
      return null;
    }
  }

  /** Adds the values of a file at the vertices as fields, and colors the shape by the first. */
  private async addFields(file: File): Promise<void> {
    const { studio } = this;
    const { id } = studio.shape!;
    const added = await studio.wait(text.reading(file.name), (signal) =>
      studio.api.addFields(id, file, file.name, signal),
    );
    if (!added || studio.shape?.id !== id) return;
    const { fields } = await studio.api.shape(id);
    studio.shape = { ...studio.shape, fields };
    studio.emit('fields');
    studio.showField(added.fields[0]!);
    // A field of the same name has new values.
    if (studio.target !== null && added.fields.includes(studio.target)) await studio.loadTarget();
    const first = fields.find((f) => f.name === added.fields[0]);
    if (first?.series) {
      studio.showMessage(text.seriesAdded(first.series.name, framesOf(studio.shape, first.name).length));
      return;
    }
    studio.showMessage(text.fieldAdded(added.fields[0]!, first?.editable === true));
  }

  async close(id: number): Promise<void> {
    const { studio } = this;
    await this.reportErrors(async () => {
      const next = studio.shapes.shapes.find((s) => s.id !== id);
      if (!next) {
        studio.showMessage(text.lastShape);
        return;
      }
      if (studio.shape?.id === id) await this.showShape(next.id);
      await studio.api.close(id);
      await this.refreshShapes();
    });
  }

  /** Runs an action and shows its error, if any. */
  async reportErrors(what: () => Promise<void>): Promise<void> {
    try {
      await what();
    } catch (error) {
      const formats = error instanceof ApiError ? readableFormats(error.body) : null;
      const link = formats && { label: text.readableFormats, onclick: () => showFormats(formats) };
      this.studio.showMessage((error as Error).message, 'error', link ?? undefined);
    }
  }

  choose(): void {
    chooseFile('', (file) => void this.openFile(file));
  }

  async save(name: string | null = null, replace = false, valueType: string | null = null): Promise<void> {
    const { studio } = this;
    if (!studio.shape) return;
    const { shape } = studio;
    const { id } = shape;
    await this.reportErrors(async () => {
      try {
        await studio.saver?.waitUntilSent();
        const { path, notes } = await studio.api.save(id, name, replace, valueType);
        const left = stillInward(shape, studio.doc.turned).length;
        if (left > 0) notes.push(text.savedInward(left, shape.components));
        studio.showMessage([text.saved(path), ...notes].join(' '));
      } catch (error) {
        if (!(error instanceof ApiError) || !(error.body as { exists?: boolean } | null)?.exists) throw error;
        const again = { label: text.replaceFile, onclick: () => void this.save(name, true, valueType) };
        studio.showMessage(error.message, 'error', again);
      }
    });
  }

  /** Name of the shape without its extension. */
  get stem(): string {
    return stem(this.studio.shape!.name);
  }

  /** Ends the studio; the command or Python session that started it receives the edit. */
  async quitStudio(): Promise<void> {
    await this.reportErrors(async () => {
      await this.studio.saver?.waitUntilSent();
      await this.studio.api.endStudio();
      document
        .getElementById('app')!
        .replaceChildren(h('p', { class: 'fatal', role: 'status' }, text.finished));
    });
  }

  /** Downloads the edit as a file, without the server, to be opened in the next studio. */
  saveEdit(): void {
    const edit = JSON.stringify(toEdit(this.studio.doc, 0));
    download(new Blob([edit], { type: 'application/json' }), `${this.stem}.edit.json`);
  }

  /** Downloads the shape with working sliders as one HTML file. */
  async page(): Promise<void> {
    const { studio } = this;
    studio.showMessage(text.working);
    await this.reportErrors(async () => {
      await studio.saver?.waitUntilSent();
      const page = await studio.api.page(studio.shape!.id);
      download(new Blob([page], { type: 'text/html' }), `${this.stem}.html`);
      studio.showMessage(text.pageMade((page.size / 1e6).toFixed(1)));
    });
  }

  async picture(): Promise<void> {
    await this.reportErrors(async () => {
      const { view, isGrid, gridView } = this.studio;
      if (isGrid) {
        download(await gridView.picture(), `${this.stem}.png`);
        return;
      }
      // The buffer of the canvas holds the picture only until the end of the task that drew it.
      view.draw();
      const legend = document.querySelector<HTMLElement>('.legend');
      download(await pictureWithLegend(view.canvas, legend), `${this.stem}.png`);
    });
  }

  /** Opens the dialog for saving, downloads and recipes. */
  openMenu(): void {
    const { shape } = this.studio;
    if (!shape) return;
    const close = () => box.close();
    const left = stillInward(shape, this.studio.doc.turned).length;
    const notes = left > 0 ? [text.inwardFile(left, shape.components), ...shape.notes] : shape.notes;
    const box = dialog(
      text.file,
      ...this.saveSection(close),
      ...this.downloadSection(shape, close),
      ...this.fieldSection(shape),
      ...this.recipeSection(shape, close),
      // On wide screens these have buttons of their own.
      h(
        'div',
        { class: 'row narrow-only' },
        shape.grid
          ? null
          : button(text.tools, () => {
              close();
              this.openTools();
            }),
        button(text.theme, () => this.studio.toggleTheme()),
      ),
      h('h3', {}, text.quit),
      h('p', {}, text.quitNote),
      h(
        'div',
        { class: 'row' },
        button(text.quit, () => {
          close();
          this.askToQuit();
        }),
      ),
      notes.length ? h('h3', {}, text.notes) : null,
      notes.length ? h('ul', {}, ...notes.map((n) => h('li', {}, n))) : null,
    );
  }

  /** Opens the dialog of denoising, comparison and report. */
  openTools(): void {
    if (!this.studio.shape) return;
    const box = dialog(text.tools, ...toolSections(this.studio, this, () => box.close()));
  }

  private askToQuit(): void {
    const box = dialog(
      text.quit,
      h('p', {}, text.quitQuestion),
      h(
        'div',
        { class: 'actions' },
        button(
          text.quit,
          () => {
            box.close();
            void this.quitStudio();
          },
          'primary',
        ),
      ),
    );
  }

  /** Creates the choice of the type of numbers of an image or a volume: that of its file, or 32-bit numbers. */
  private numberType(): HTMLSelectElement | null {
    const { shape } = this.studio;
    if (!shape?.grid) return null;
    const own = text.numberTypes[shape.grid.value_type] ?? shape.grid.value_type;
    return h(
      'select',
      { 'aria-label': text.numberType },
      h('option', { value: '' }, text.numbersOfFile(own)),
      h('option', { value: 'f32' }, text.numberTypes['f32']!),
    );
  }

  private saveSection(close: () => void): Node[] {
    const name = h('input', { type: 'text', placeholder: text.saveNameHint, 'aria-label': text.saveName });
    let replace = false;
    const type = this.numberType();
    const save = () => {
      close();
      void this.save(name.value.trim() || null, replace, type?.value || null);
    };
    return [
      h('h3', {}, text.save),
      h('p', {}, text.saveNote),
      h('div', { class: 'row' }, name, type, button(text.save, save, 'primary')),
      check(text.saveReplace, false, (on) => {
        replace = on;
      }),
    ];
  }

  private downloadSection(shape: Shape, close: () => void): (Node | null)[] {
    const { studio } = this;
    const format = h(
      'select',
      { 'aria-label': text.format },
      ...shape.formats.map((f) => h('option', { value: f }, text.formatName(f))),
    );
    const current = shape.formats.find((f) => f.toLowerCase() === shape.format?.toLowerCase());
    if (current) format.value = current;
    const type = this.numberType();
    const downloadShape = () =>
      void this.reportErrors(async () => {
        await studio.saver?.waitUntilSent();
        const id = format.value.toLowerCase();
        const usual = id === 'gifti' ? 'gii' : id.replace('-ascii', '');
        const extension = shape.grid?.extensions[id] ?? usual;
        const content = await studio.api.download(shape.id, id, type?.value || null);
        download(content, `${this.stem}-edited.${extension}`);
      });
    return [
      h('h3', {}, text.downloads),
      h('div', { class: 'row' }, format, type, button(text.download, downloadShape)),
      h(
        'div',
        { class: 'row' },
        button(text.picture, () => void this.picture()),
        button(text.picturesOpen, () => {
          close();
          this.pictures.open();
        }),
        ...(shape.grid ? [] : this.shapeDownloads(shape, close)),
      ),
      shape.grid || shape.graph ? null : h('p', { class: 'hint' }, text.pageNote),
    ];
  }

  /** Creates the downloads of shapes alone: the view, and a page with sliders unless it is a graph. */
  private shapeDownloads(shape: Shape, close: () => void): Node[] {
    const { studio } = this;
    return [
      button(text.viewFile, () => {
        const view = JSON.stringify(studio.shownView?.get());
        download(new Blob([view], { type: 'application/json' }), `${this.stem}.view.json`);
      }),
      ...(shape.graph
        ? []
        : [
            button(text.pageGo, () => {
              close();
              void this.page();
            }),
          ]),
    ];
  }

  /** Creates the downloads of the field that colors the shape. */
  private fieldSection(shape: Shape): Node[] {
    const { studio } = this;
    const name = studio.shownField;
    if (name === null) return [];
    const format = h(
      'select',
      { 'aria-label': text.fieldFormat },
      ...text.fieldFormats.map(([id, title]) => h('option', { value: id }, title)),
    );
    const save = (what: () => Promise<void>) => () =>
      void this.reportErrors(async () => {
        await studio.saver?.waitUntilSent();
        await what();
      });
    const values = save(async () => {
      const extension = format.value;
      download(await studio.api.fieldFile(shape.id, name, extension), `${name}-edited.${extension}`);
    });
    const recipe = () => this.downloadRecipe(shape, name);
    return [
      h('h3', {}, text.fieldValues(name)),
      h(
        'div',
        { class: 'row' },
        format,
        button(text.fieldDownload, values),
        button(text.recipeOf(name), recipe),
      ),
    ];
  }

  /** Downloads the recipe of a field, or of the positions (`null`). */
  private downloadRecipe(shape: Shape, field: string | null): void {
    const { studio } = this;
    void this.reportErrors(async () => {
      await studio.saver?.waitUntilSent();
      const recipe = await studio.api.recipe(shape.id, field);
      download(new Blob([recipe], { type: 'application/toml' }), `${field ?? this.stem}.toml`);
    });
  }

  private recipeSection(shape: Shape, close: () => void): Node[] {
    const { studio } = this;
    // Positions that are not edited have no recipe; that of the shown field is among its values.
    const edited = studio.doc.fields.filter((f) => !areNeutral(f.layers)).map((f) => f.field);
    const names: (string | null)[] = isNeutral(studio.doc) && edited.length > 0 ? edited : [null];
    const downloads = names
      .filter((name) => name === null || name !== studio.shownField)
      .map((name) =>
        button(name === null ? text.recipeSave : text.recipeOf(name), () => this.downloadRecipe(shape, name)),
      );
    const openRecipe = () =>
      chooseFile('.toml', (file) => {
        close();
        void this.reportErrors(async () => studio.session.applyRecipe(await file.text()));
      });
    return [
      h('h3', {}, text.recipe),
      h('p', {}, text.recipeNote),
      h('div', { class: 'row' }, ...downloads, button(text.recipeOpen, openRecipe)),
    ];
  }

  /** Creates the tabs of the open shapes. */
  tabs(): HTMLElement {
    const { studio } = this;
    const nav = h('nav', { class: 'tabs', 'aria-label': text.shapes });
    const rebuild = () => {
      nav.replaceChildren(
        ...studio.shapes.shapes.map((s) => {
          const here = s.id === studio.shape?.id;
          return h(
            'span',
            { class: here ? 'tab here' : 'tab' },
            h(
              'button',
              {
                type: 'button',
                'aria-current': here ? 'page' : undefined,
                title: s.name,
                onclick: () => void this.showShape(s.id),
              },
              s.name,
            ),
            studio.shapes.shapes.length > 1
              ? iconButton('close', text.closeShape(s.name), () => void this.close(s.id))
              : null,
          );
        }),
        iconButton('plus', text.open, () => this.choose()),
      );
    };
    studio.on(['shapes', 'shape'], rebuild);
    return nav;
  }

  /** Accepts files dropped anywhere on the page. */
  acceptDrops(target: HTMLElement): void {
    target.addEventListener('dragover', (e) => {
      e.preventDefault();
      target.classList.add('dropping');
    });
    target.addEventListener('dragleave', (e) => {
      if (!e.relatedTarget) target.classList.remove('dropping');
    });
    target.addEventListener('drop', (e) => {
      e.preventDefault();
      target.classList.remove('dropping');
      for (const file of e.dataTransfer?.files ?? []) void this.openFile(file);
    });
  }
}

function button(label: string, onclick: () => void, kind = ''): HTMLButtonElement {
  return h('button', { type: 'button', class: kind, onclick }, label);
}

/** Returns the supported formats that the server lists in its error about an unknown one. */
function readableFormats(body: unknown): ReadableFormat[] | null {
  const formats = (body as { readable_formats?: ReadableFormat[] } | null)?.readable_formats;
  return Array.isArray(formats) ? formats : null;
}

function showFormats(formats: ReadableFormat[]): void {
  dialog(
    text.readableFormats,
    h(
      'ul',
      { class: 'formats' },
      ...formats.map((f) => h('li', {}, f.title, ' ', h('small', {}, f.extensions.join(' ')))),
    ),
  );
}

function stem(name: string): string {
  return name.replace(/(\.gz)?$/i, '').replace(/\.[^.]*$/, '') || 'shape';
}
