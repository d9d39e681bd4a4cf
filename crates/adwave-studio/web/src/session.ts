/** The displayed shape of the server: fetching it with bands and edit, and replacing its levels or its edit. */

import type { ShapeRequest } from './boot';
import { coarseTriangles } from './compute/coarse';
import type { Edit, EditSummary, Level } from './protocol';
import { fetchEditAfterReload, Saver } from './saver';
import { type Doc, fromEdit, isNeutral, needsServer } from './state';
import type { Studio } from './studio';
import { text } from './text';

/** Number of triangles of the coarse version. */
const COARSE = 45_000;
/** Number of triangles above which the coarse version is drawn first. */
const COARSE_FIRST = 200_000;

export class Session {
  /** Counter of shapes and levels; responses to requests of an older generation are ignored. */
  generation = 0;

  constructor(private readonly studio: Studio) {}

  /** Opens a shape of the server: first its picture, then its bands from coarse to fine. */
  async open(early: ShapeRequest): Promise<void> {
    const { studio } = this;
    const { view, timings, api } = studio;
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
      // The coarse version is ready sooner; the full one is drawn when the page is at rest.
      coarsen();
      view.markMoving();
    }
    view.draw();
    if (!timings.records.firstPixels) {
      view.finish();
      timings.records.firstPixels = performance.now();
    }
    studio.resetForShape();
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
    const edit = await fetchEditAfterReload(api, shape.id);
    if (generation !== this.generation) return;
    this.startEditing(fromEdit(edit, shape.levels.length), edit.revision);
    studio.emit('shape');
    studio.emit('levels');
    void normals.then(({ normals }) => {
      if (generation === this.generation) view.arrays.setNormals(normals);
    });
    await bands;
    if (generation !== this.generation) return;
    // Until the coarse version is ready, the worker sums the bands while a slider moves.
    if (view.arrays.heavy && !few) coarsen();
    if (!isNeutral(studio.doc)) studio.display.settle();
    void studio.engine.call('warm', {});
  }

  /** Starts editing a document of the server; further steps are saved there. */
  private startEditing(doc: Doc, revision: number): void {
    const { studio } = this;
    studio.saver?.detach();
    studio.saver = new Saver(studio.api, studio.shape!.id, revision, (moved) => this.handleSaved(moved));
    studio.resetDocument(doc);
    studio.emit('saving');
  }

  /** Handles a finished or failed save. */
  private handleSaved(moved: EditSummary | null): void {
    const { studio } = this;
    if (moved) {
      studio.displacement = moved;
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
      if (generation === this.generation) studio.showMessage((error as Error).message, 'error');
    }
  }

  /** Replaces the levels and fetches the new bands. The server resets gains if their number changes. */
  async setLevels(what: unknown): Promise<void> {
    const { studio } = this;
    const { shape, api } = studio;
    if (!shape) return;
    await studio.saver?.pauseDuring(async () => {
      const levels = await api.levels(shape.id, what);
      this.replaceLevels(levels, await api.edit(shape.id));
    });
    await this.readLevels();
    // Presets depend on the number of levels.
    const { presets } = await api.shape(shape.id);
    studio.shape = { ...studio.shape!, presets };
    studio.emit('levels');
  }

  private replaceLevels(levels: Level[], edit: Edit): void {
    const { studio } = this;
    this.generation++;
    studio.shape = { ...studio.shape!, levels };
    studio.loadedBands.clear();
    studio.view.setLevels(levels.length);
    studio.view.arrays.setUnedited();
    this.startEditing(fromEdit(edit, levels.length), edit.revision);
    studio.emit('levels');
  }

  private async readLevels(): Promise<void> {
    const { generation } = this;
    await this.readBands(generation);
    if (generation === this.generation) this.studio.display.settle();
  }

  /** Applies the levels and the edit of a recipe. */
  async applyRecipe(recipe: string): Promise<void> {
    const { studio } = this;
    await studio.saver?.pauseDuring(async () => {
      const { levels, edit } = await studio.api.putRecipe(studio.shape!.id, recipe);
      this.replaceLevels(levels, edit);
    });
    await this.readLevels();
  }

  /** Applies an edit from a file as one step. */
  applyEdit(edit: Edit): void {
    const { nLevels, history } = this.studio;
    const fits = Array.isArray(edit.layers) && edit.layers.every((l) => l.gains.length === nLevels);
    if (!fits) throw new Error(text.badEdit(nLevels));
    history.commit(fromEdit(edit, nLevels));
  }

  /** Replaces the edit by the conflicting one of another page. */
  acceptConflictingEdit(): void {
    const { saver, nLevels, display } = this.studio;
    const edit = saver?.conflictingEdit;
    if (!edit) return;
    saver.resolve(false);
    this.startEditing(fromEdit(edit, nLevels), edit.revision);
    display.settle();
  }
}
