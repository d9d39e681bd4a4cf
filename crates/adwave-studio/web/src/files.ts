/** Files: open, save, download, recipe, picture; tabs for several shapes. */

import type { fetchShape as FetchShape } from './boot';
import { dialog } from './dialog';
import { check, chooseFile, download, h, iconButton } from './dom';
import type { Edit } from './protocol';
import { toEdit } from './state';
import type { Studio } from './studio';
import { text } from './text';
import { tools } from './tools';

export class Files {
  constructor(
    private readonly studio: Studio,
    private readonly fetchShape: typeof FetchShape,
  ) {}

  async go(id: number): Promise<void> {
    try {
      await this.studio.session.open(this.fetchShape(this.studio.api, id));
    } catch (error) {
      this.studio.say((error as Error).message, 'error');
    }
  }

  async list(): Promise<void> {
    this.studio.shapes = await this.studio.api.shapes();
    this.studio.emit('shapes');
  }

  async openFile(file: File): Promise<void> {
    const { studio } = this;
    if (/\.toml$/i.test(file.name)) {
      await this.try(async () => studio.session.takeRecipe(await file.text()));
      return;
    }
    if (/\.edit\.json$/i.test(file.name)) {
      await this.try(async () => studio.session.takeEdit(JSON.parse(await file.text()) as Edit));
      return;
    }
    studio.say(text.reading(file.name));
    await this.try(async () => {
      const { id } = await studio.api.open(file, file.name);
      await this.list();
      await this.go(id);
    });
  }

  async close(id: number): Promise<void> {
    const { studio } = this;
    await this.try(async () => {
      const next = studio.shapes.shapes.find((s) => s.id !== id);
      if (!next) {
        studio.say(text.lastShape);
        return;
      }
      if (studio.shape?.id === id) await this.go(next.id);
      await studio.api.close(id);
      await this.list();
    });
  }

  /** Does it, and says what went wrong. */
  async try(what: () => Promise<void>): Promise<void> {
    try {
      await what();
    } catch (error) {
      this.studio.say((error as Error).message, 'error');
    }
  }

  choose(): void {
    chooseFile('', (file) => void this.openFile(file));
  }

  async save(name: string | null = null, replace = false): Promise<void> {
    const { studio } = this;
    if (!studio.shape) return;
    await this.try(async () => {
      await studio.saver?.sent();
      const { path, notes } = await studio.api.save(studio.shape!.id, name, replace);
      studio.say([text.saved(path), ...notes].join(' '));
    });
  }

  /** The name of the shape without its ending. */
  get stem(): string {
    return stem(this.studio.shape!.name);
  }

  /** Ends the studio; who opened it, the command or Python, has the edit then. */
  async done(): Promise<void> {
    await this.try(async () => {
      await this.studio.saver?.sent();
      await this.studio.api.done();
      document
        .getElementById('app')!
        .replaceChildren(h('p', { class: 'fatal', role: 'status' }, text.finished));
    });
  }

  /** The edit as a file, for the studio that is started next: it needs no server. */
  saveEdit(): void {
    const edit = JSON.stringify(toEdit(this.studio.doc, 0));
    download(new Blob([edit], { type: 'application/json' }), `${this.stem}.edit.json`);
  }

  /** The shape with working sliders, as one file. */
  async page(): Promise<void> {
    const { studio } = this;
    studio.say(text.working);
    await this.try(async () => {
      await studio.saver?.sent();
      const page = await studio.api.page(studio.shape!.id);
      download(new Blob([page], { type: 'text/html' }), `${this.stem}.html`);
      studio.say(text.pageMade((page.size / 1e6).toFixed(1)));
    });
  }

  async picture(): Promise<void> {
    await this.try(async () => download(await this.studio.view.picture(), `${this.stem}.png`));
  }

  /** All that leaves the studio, in one dialog. */
  menu(): void {
    const { studio } = this;
    const { shape } = studio;
    if (!shape) return;
    const name = h('input', { type: 'text', placeholder: text.saveNameHint, 'aria-label': text.saveName });
    const format = h(
      'select',
      { 'aria-label': text.format },
      ...shape.formats.map((f) => h('option', { value: f }, f)),
    );
    const own = shape.formats.find((f) => f.toLowerCase() === shape.format?.toLowerCase());
    if (own) format.value = own;
    const button = (label: string, act: () => void, kind = '') =>
      h('button', { type: 'button', class: kind, onclick: act }, label);
    let replace = false;
    const box = dialog(
      text.file,
      h('h3', {}, text.save),
      h('p', {}, text.saveNote),
      h(
        'div',
        { class: 'row' },
        name,
        button(
          text.save,
          () => {
            box.close();
            void this.save(name.value.trim() || null, replace);
          },
          'primary',
        ),
      ),
      check(text.saveReplace, false, (on) => {
        replace = on;
      }),
      h('h3', {}, text.downloads),
      h(
        'div',
        { class: 'row' },
        format,
        button(
          text.download,
          () =>
            void this.try(async () => {
              await studio.saver?.sent();
              const kind = format.value.toLowerCase();
              const ending = kind === 'gifti' ? 'gii' : kind.replace('-ascii', '');
              download(await studio.api.download(shape.id, kind), `${this.stem}-edited.${ending}`);
            }),
        ),
      ),
      h(
        'div',
        { class: 'row' },
        button(text.picture, () => void this.picture()),
        button(text.pageGo, () => {
          box.close();
          void this.page();
        }),
      ),
      h('p', { class: 'hint' }, text.pageNote),
      h('h3', {}, text.recipe),
      h('p', {}, text.recipeNote),
      h(
        'div',
        { class: 'row' },
        button(
          text.recipeSave,
          () =>
            void this.try(async () => {
              await studio.saver?.sent();
              const recipe = await studio.api.recipe(shape.id);
              download(new Blob([recipe], { type: 'application/toml' }), `${this.stem}.toml`);
            }),
        ),
        button(text.recipeOpen, () =>
          chooseFile('.toml', (file) => {
            box.close();
            void this.try(async () => studio.session.takeRecipe(await file.text()));
          }),
        ),
      ),
      ...tools(studio, this, () => box.close()),
      h('h3', {}, text.finish),
      h('p', {}, text.finishNote),
      h(
        'div',
        { class: 'row' },
        button(text.done, () => {
          box.close();
          void this.done();
        }),
      ),
      shape.notes.length ? h('h3', {}, text.notes) : null,
      shape.notes.length ? h('ul', {}, ...shape.notes.map((n) => h('li', {}, n))) : null,
    );
  }

  /** The shapes that are open, as tabs. */
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
                onclick: () => void this.go(s.id),
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

  /** Files may be dropped anywhere. */
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

function stem(name: string): string {
  return name.replace(/(\.gz)?$/i, '').replace(/\.[^.]*$/, '') || 'shape';
}
