/** The shape of the server that is open on the page: fetched with its bands and its edit, and what replaces its levels or its edit. */

import type { Early } from './boot';
import { coarseTriangles } from './compute/coarse';
import type { Edit, Level, Moved } from './protocol';
import { keptAfterReload, Saver } from './saver';
import { type Doc, fromEdit, isNeutral, needsServer } from './state';
import type { Studio } from './studio';
import { text } from './text';

/** Triangles of a large shape while it moves. */
const COARSE = 45_000;
/** Triangles of a shape that is first drawn with fewer. */
const COARSE_FIRST = 200_000;

export class Session {
  /** Another number when another shape or other levels are there: what was asked for before is too late. */
  generation = 0;

  constructor(private readonly studio: Studio) {}

  /** Opens a shape of the server: its picture first, then its bands, coarse to fine. */
  async open(early: Early): Promise<void> {
    const { studio } = this;
    const { view, watch, api } = studio;
    const generation = ++this.generation;
    studio.saver?.close();
    const [shape, positions, triangles] = await Promise.all([early.shape, early.positions, early.triangles]);
    if (generation !== this.generation) return;
    if (positions.length === 0) throw new Error(text.noPositions(shape.name));
    studio.shape = shape;
    sessionStorage.setItem('adwave-shape', String(shape.id));
    const cloud = triangles.length === 0;
    view.setShape(positions, triangles, cloud, shape.mean_length || shape.diagonal / 100);
    const coarsen = () => view.arrays.setCoarse(coarseTriangles(positions, triangles, COARSE));
    const few = view.arrays.heavy && shape.n_triangles > COARSE_FIRST;
    if (few) {
      // Fewer triangles are there sooner; all of them follow when the page is at rest.
      coarsen();
      view.touch();
    }
    view.draw();
    if (!watch.timings.firstPixels) {
      view.finish();
      watch.timings.firstPixels = performance.now();
    }
    studio.forgetShape();
    view.setLevels(shape.levels.length);
    const normals = studio.engine.call('shape', {
      url: `${api.root}api/shapes/${shape.id}/`,
      token: api.token,
      n: shape.n_vertices,
      center: shape.center,
      diagonal: shape.diagonal,
      meanLength: shape.mean_length || shape.diagonal / 100,
      cloud,
      positions,
      triangles,
    });
    const bands = this.readBands(generation);
    const edit = await keptAfterReload(api, shape.id);
    if (generation !== this.generation) return;
    this.begin(fromEdit(edit, shape.levels.length), edit.revision);
    studio.emit('shape');
    studio.emit('levels');
    void normals.then(({ normals }) => {
      if (generation === this.generation) view.arrays.setNormals(normals);
    });
    await bands;
    if (generation !== this.generation) return;
    // Until then the worker sums what a slider moves.
    if (view.arrays.heavy && !few) coarsen();
    if (!isNeutral(studio.doc)) studio.display.settle();
    void studio.engine.call('warm', {});
  }

  /** A document from the server becomes the present one, and what is done to it from here on is kept there. */
  private begin(doc: Doc, revision: number): void {
    const { studio } = this;
    studio.saver?.leave();
    studio.saver = new Saver(studio.api, studio.shape!.id, revision, (moved) => this.hear(moved));
    studio.startFrom(doc);
    studio.emit('saving');
  }

  /** The server has kept the edit, or could not. */
  private hear(moved: Moved | null): void {
    const { studio } = this;
    if (moved) {
      studio.moved = moved;
      studio.emit('moved');
      if (needsServer(studio.doc, studio.shape!.kind === 'cloud')) studio.display.settle();
    }
    studio.emit('saving');
  }

  private async readBands(generation: number): Promise<void> {
    const { studio } = this;
    const shared = crossOriginIsolated && typeof SharedArrayBuffer !== 'undefined';
    try {
      await studio.engine.call('bands', { nLevels: studio.nLevels, shared });
    } catch (error) {
      if (generation === this.generation) studio.say((error as Error).message, 'error');
    }
  }

  /** Other levels: bands are fetched anew, and gains of another number of levels are dropped by the server. */
  async setLevels(what: unknown): Promise<void> {
    const { studio } = this;
    const { shape, api } = studio;
    if (!shape) return;
    await studio.saver?.whileReplaced(async () => {
      const levels = await api.levels(shape.id, what);
      this.startLevels(levels, await api.edit(shape.id));
    });
    await this.readLevels();
    // Presets have as many gains as there are levels.
    const { presets } = await api.shape(shape.id);
    studio.shape = { ...studio.shape!, presets };
    studio.emit('levels');
  }

  private startLevels(levels: Level[], edit: Edit): void {
    const { studio } = this;
    this.generation++;
    studio.shape = { ...studio.shape!, levels };
    studio.arrived.clear();
    studio.view.setLevels(levels.length);
    studio.view.arrays.setUnedited();
    this.begin(fromEdit(edit, levels.length), edit.revision);
    studio.emit('levels');
  }

  private async readLevels(): Promise<void> {
    const { generation } = this;
    await this.readBands(generation);
    if (generation === this.generation) this.studio.display.settle();
  }

  /** A recipe from a file: its levels and its edit. */
  async takeRecipe(recipe: string): Promise<void> {
    const { studio } = this;
    await studio.saver?.whileReplaced(async () => {
      const { levels, edit } = await studio.api.putRecipe(studio.shape!.id, recipe);
      this.startLevels(levels, edit);
    });
    await this.readLevels();
  }

  /** An edit from a file, as one step. */
  takeEdit(edit: Edit): void {
    const { nLevels, history } = this.studio;
    const fits = Array.isArray(edit.layers) && edit.layers.every((l) => l.gains.length === nLevels);
    if (!fits) throw new Error(text.badEdit(nLevels));
    history.commit(fromEdit(edit, nLevels));
  }

  /** After a conflict: what another page made of the edit. */
  takeTheirs(): void {
    const { saver, nLevels, display } = this.studio;
    const edit = saver?.theirs;
    if (!edit) return;
    saver.resolve(false);
    this.begin(fromEdit(edit, nLevels), edit.revision);
    display.settle();
  }
}
