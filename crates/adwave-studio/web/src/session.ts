/** The displayed shape of the server: fetching it with bands and edit, and replacing its levels or its edit. */

import type { ShapeRequest } from './boot';
import { coarseTriangles } from './compute/coarse';
import { rememberGrid } from './grid/grid-memory';
import { restoreHistory, storeHistory } from './history-store';
import type { Edit, EditSummary, LevelsAnswer, LevelsChoice, Shape } from './protocol';
import { fetchEditAfterReload, Saver } from './saver';
import { type Doc, type DocLevels, fromEdit, isNeutral, needsServer, withLevels } from './state';
import type { Studio } from './studio';
import { text } from './text';
import { placeCamera, rememberView } from './view-memory';

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
    this.storeHistory();
    studio.saver?.close();
    const [shape, positions, triangles] = await Promise.all([early.shape, early.positions, early.triangles]);
    if (generation !== this.generation) return;
    if (shape.grid) {
      await this.openGrid(shape, generation);
      return;
    }
    const edges = shape.graph ? await api.indices(`shapes/${shape.id}/edges`) : null;
    if (generation !== this.generation) return;
    studio.shape = shape;
    studio.showDomain();
    sessionStorage.setItem('adwave-shape', String(shape.id));
    const cloud = triangles.length === 0;
    const graph = edges && { edges, isFlat: shape.graph!.flat };
    view.setShape(positions, triangles, graph, shape.mean_length || shape.diagonal / 100);
    placeCamera(view.camera, shape);
    const coarsen = () => view.arrays.setCoarse(coarseTriangles(positions, triangles, COARSE));
    const few = view.arrays.heavy && shape.n_triangles > COARSE_FIRST;
    // The coarse version is ready sooner; the full one is drawn when the page is at rest.
    if (few) coarsen();
    view.markMoving();
    view.draw();
    if (!timings.records.firstPixels) {
      view.finish();
      timings.records.firstPixels = performance.now();
    }
    studio.resetForShape();
    studio.turnedParts.reset(triangles, COARSE);
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
      edges,
      countsEdges: shape.graph?.placed === true,
    });
    const bands = this.readBands(generation);
    const edit = await fetchEditAfterReload(api, shape.id);
    if (generation !== this.generation) return;
    this.startEditing(fromEdit(edit, shape.levels.length, docLevels(shape)), edit.revision);
    restoreHistory(shape, studio.history);
    studio.emit('shape');
    studio.emit('levels');
    void normals.then(({ normals }) => {
      if (generation === this.generation) view.arrays.setNormals(normals);
    });
    await bands;
    if (generation !== this.generation) return;
    // Until the coarse version is ready, the worker sums the bands while a slider moves.
    if (view.arrays.heavy && !few) coarsen();
    await this.showEdit(generation);
    void studio.engine.call('warm', {});
  }

  /** Opens an image or a volume: its panes load values and bands as they are seen. */
  private async openGrid(shape: Shape, generation: number): Promise<void> {
    const { studio } = this;
    const edit = await fetchEditAfterReload(studio.api, shape.id);
    if (generation !== this.generation) return;
    studio.shape = shape;
    sessionStorage.setItem('adwave-shape', String(shape.id));
    studio.tool = 'look';
    studio.resetForShape();
    studio.displacement = { ...shape.grid!.change, volume: null };
    this.startEditing(fromEdit(edit, shape.levels.length, docLevels(shape)), edit.revision);
    restoreHistory(shape, studio.history);
    studio.showDomain();
    const opened = studio.gridView.open(shape.grid!);
    studio.emit('shape');
    this.markBandsReady();
    await opened;
    if (generation === this.generation) studio.timings.records.slidersLive = performance.now();
  }

  /** Enables the sliders of an image or a volume. */
  private markBandsReady(): void {
    const { studio } = this;
    for (let level = 1; level <= studio.nLevels; level++) studio.loadedBands.add(level);
    studio.isEditShown = true;
    studio.emit('levels');
    studio.emit('band');
  }

  /** Shows the edit once its bands are there. Until then its sliders wait: the picture is not that of their gains. */
  private async showEdit(generation: number): Promise<void> {
    const { studio } = this;
    if (studio.isEditShown) return;
    studio.display.show(true);
    if (!studio.display.isCurrent) await studio.display.waitUntilSettled();
    if (generation !== this.generation) return;
    studio.isEditShown = true;
    studio.timings.records.slidersLive = performance.now();
    studio.emit('band');
  }

  /** Stores the steps for the next visit of this tab. */
  storeHistory(): void {
    const { shape, history, saver } = this.studio;
    if (!shape || !saver) return;
    storeHistory(shape, history);
    if (shape.grid) rememberGrid(shape, this.studio.gridView.memory);
    else if (this.studio.shownView) rememberView(shape, this.studio.shownView.get());
  }

  /** Starts editing a document of the server; further steps are saved there. */
  private startEditing(doc: Doc, revision: number): void {
    const { studio } = this;
    studio.saver?.detach();
    studio.saver = new Saver(studio.api, studio.shape!.id, revision, (moved) => this.handleSaved(moved));
    studio.resetDocument(doc);
    studio.isEditShown = isNeutral(doc);
    studio.emit('saving');
  }

  /** Handles a finished or failed save. */
  private handleSaved(moved: EditSummary | null): void {
    const { studio } = this;
    if (moved) {
      studio.displacement = moved;
      studio.emit('moved');
      if (!studio.isGrid && needsServer(studio.doc, studio.shape!)) studio.display.settle();
      void studio.fieldEditor.refine().catch(() => {});
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

  /** Replaces the levels as one step; gains follow their widths, also those that change while the server computes. */
  async setLevels(choice: LevelsChoice): Promise<void> {
    await this.replaceLevels(
      (signal) => this.studio.api.levels(this.studio.shape!.id, choice, signal),
      ({ levels }) => this.studio.history.commit(withLevels(this.studio.doc, levels)),
    );
  }

  /** Steps to a document whose levels differ from the present ones. */
  async stepOverLevels(to: 'undo' | 'redo'): Promise<void> {
    const { studio } = this;
    const doc = studio.history.peek(to);
    if (!doc) return;
    await this.replaceLevels(
      (signal) => studio.api.levels(studio.shape!.id, doc.levels.choice, signal),
      ({ levels }) => {
        // A step that was made meanwhile stays.
        if (studio.history.peek(to) === doc) studio.history[to]();
        else studio.history.commit(withLevels(studio.doc, levels));
      },
    );
  }

  /** Applies the levels and the edit of a recipe as one step, and shows what it edits: the positions or a field. */
  async applyRecipe(recipe: string): Promise<void> {
    const { studio } = this;
    let target: string | null | undefined;
    await this.replaceLevels(
      (signal) => studio.api.putRecipe(studio.shape!.id, recipe, signal),
      ({ levels, edit, field }) => {
        studio.history.commit(fromEdit(edit, levels.sigmas.length, levels));
        target = field ?? null;
      },
    );
    if (target !== undefined) studio.showTarget(target);
  }

  /**
   * Lets the server compute other levels, and takes a step to a document of these levels once they are there. Meanwhile the
   * present document can be edited.
   */
  private async replaceLevels(
    request: (signal: AbortSignal) => Promise<LevelsAnswer>,
    step: (answer: { levels: DocLevels; edit: Edit; field?: string | null }) => void,
  ): Promise<void> {
    const { studio } = this;
    const { generation } = this;
    const { saver } = studio;
    if (!studio.shape || !saver) return;
    const answer = await studio.wait(text.computingBands, (signal) =>
      saver.pauseDuring(async (revise) => {
        const answer = await request(signal);
        revise(answer.edit.revision);
        return answer;
      }),
    );
    if (!answer || generation !== this.generation) return;
    const { levels } = answer;
    this.generation++;
    studio.history.end();
    studio.shape = { ...studio.shape, levels, choice: answer.choice };
    studio.loadedBands.clear();
    // The bands of an edited field are of other levels too.
    studio.fieldEditor.close();
    studio.solo = null;
    if (!studio.isGrid) {
      studio.view.setLevels(levels.length);
      studio.view.arrays.setUnedited();
    }
    step({ ...answer, levels: docLevels(studio.shape) });
    if (studio.isGrid) {
      studio.gridView.reload();
      this.markBandsReady();
      await studio.gridView.waitUntilSettled();
    } else {
      studio.isEditShown = isNeutral(studio.doc);
      studio.emit('levels');
      await this.readLevels();
    }
    // Presets and fields depend on the number of levels.
    const { presets, fields } = await studio.api.shape(studio.shape.id);
    studio.shape = { ...studio.shape, presets, fields };
    studio.emit('levels');
  }

  private async readLevels(): Promise<void> {
    const { generation } = this;
    await this.readBands(generation);
    if (generation !== this.generation) return;
    await this.showEdit(generation);
    await this.studio.loadTarget();
  }

  /** Applies an edit from a file as one step. */
  applyEdit(edit: Edit): void {
    const { nLevels, history } = this.studio;
    const lists = [edit, ...(edit.fields ?? [])].map((list) => list.layers);
    const fits = lists.every((l) => Array.isArray(l) && l.every((layer) => layer.gains.length === nLevels));
    if (!fits) throw new Error(text.badEdit(nLevels));
    history.commit(fromEdit(edit, nLevels, this.studio.doc.levels));
  }

  /** Replaces the edit by the conflicting one of another page. */
  acceptConflictingEdit(): void {
    const { saver, nLevels, display } = this.studio;
    const edit = saver?.conflictingEdit;
    if (!edit) return;
    saver.resolve(false);
    const doc = fromEdit(edit, nLevels, this.studio.doc.levels);
    // The replaced edit can be had back with undo.
    this.studio.history.commit(doc);
    display.settle();
  }
}

function docLevels({ choice, levels }: Shape): DocLevels {
  return { choice, sigmas: levels.map((l) => l.sigma) };
}
