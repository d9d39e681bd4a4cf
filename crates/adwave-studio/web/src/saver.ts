/** Sends the edit to the server after each step, and retries while the server is unreachable. */

import { type Api, ApiError } from './api';
import type { Edit, EditSummary } from './protocol';
import { type Doc, toEdit } from './state';

/** `ended`: the server was restarted, so that the token of this page is no longer valid. */
export type SaveState = 'saved' | 'sending' | 'offline' | 'ended' | 'conflict' | 'refused';

/** Milliseconds between retries while the server is unreachable. */
const RETRY = 1500;
/** Longest time in milliseconds that a step waits for the picture. */
const PICTURE_FIRST = 400;
/** Largest request in bytes that a browser sends while the page is closed. */
const KEEPALIVE_LIMIT = 60_000;
/** Number of attempts, 100 ms apart, to find the flushed edit after a reload. */
const FLUSH_TRIES = 15;

export class Saver {
  state: SaveState = 'saved';
  problem = '';
  /** Edit on the server that conflicts with the one of this page. */
  conflictingEdit: Edit | null = null;
  private unsavedDoc: Doc | null = null;
  private sending = false;
  private retry = 0;
  private closed = false;
  private isPaused = false;

  constructor(
    private readonly api: Api,
    private readonly id: number,
    private revision: number,
    private readonly onStateChange: (moved: EditSummary | null) => void,
  ) {}

  /** Saves a step once `shown` resolves, because the server uses all processors, which the picture needs first. */
  saveStep(doc: Doc, shown: Promise<void>): void {
    this.unsavedDoc = doc;
    if (this.state === 'saved') this.setState('sending');
    void Promise.race([shown, new Promise((done) => setTimeout(done, PICTURE_FIRST))]).then(() =>
      this.send(),
    );
  }

  private setState(state: SaveState, problem = ''): void {
    this.state = state;
    this.problem = problem;
  }

  async send(): Promise<void> {
    if (this.sending || !this.unsavedDoc || this.state === 'conflict' || this.closed || this.isPaused) return;
    window.clearTimeout(this.retry);
    const doc = this.unsavedDoc;
    this.sending = true;
    if (this.state !== 'offline') this.setState('sending');
    this.onStateChange(null);
    try {
      const moved = await this.api.putEdit(this.id, toEdit(doc, ++this.revision));
      this.sending = false;
      if (this.closed) return;
      if (this.unsavedDoc === doc) {
        this.unsavedDoc = null;
        this.setState('saved');
        this.onStateChange(moved);
      } else {
        this.setState('sending');
        await this.send();
      }
    } catch (error) {
      this.sending = false;
      if (this.closed) return;
      if (error instanceof ApiError && error.status === 409) {
        this.conflictingEdit = conflictingEditOf(error.body);
        if (this.conflictingEdit) this.revision = Math.max(this.revision, this.conflictingEdit.revision);
        this.setState('conflict', error.message);
      } else if (error instanceof ApiError && error.status === 401) {
        this.setState('ended', error.message);
      } else if (error instanceof ApiError && error.status > 0) {
        // The same document would be rejected again; the next step is tried.
        this.unsavedDoc = null;
        this.setState('refused', error.message);
      } else {
        this.setState('offline', error instanceof Error ? error.message : String(error));
        this.retry = window.setTimeout(() => void this.send(), RETRY);
      }
      this.onStateChange(null);
    }
  }

  /** Resolves when the server has stored the edit, or cannot store it now. */
  async waitUntilSent(): Promise<void> {
    await this.send();
    while (this.state === 'sending' && !this.closed) await new Promise((done) => setTimeout(done, 20));
  }

  /** Resolves a conflict in favor of the edit of this page or of the one on the server. */
  resolve(keepOurs: boolean): void {
    if (this.state !== 'conflict') return;
    this.setState(keepOurs ? 'sending' : 'saved');
    if (keepOurs) void this.send();
    else this.unsavedDoc = null;
  }

  /** Sends an unsaved step while the page is closed. */
  flush(): void {
    if (!this.unsavedDoc) return;
    const edit = toEdit(this.unsavedDoc, ++this.revision);
    sessionStorage.setItem(flushedRevisionKey(this.id), String(this.revision));
    if (JSON.stringify(edit).length < KEEPALIVE_LIMIT)
      void this.api.putEdit(this.id, edit, true).catch(() => {});
  }

  close(): void {
    this.flush();
    this.detach();
  }

  /** Stops saving; another saver takes over. */
  detach(): void {
    this.unsavedDoc = null;
    this.closed = true;
    window.clearTimeout(this.retry);
  }

  /**
   * Pauses saving while the server replaces the levels, with which the gains of an edit must agree. `replace` gets a function
   * that takes over the revision of the replaced edit. Steps made meanwhile are sent afterwards.
   */
  async pauseDuring<T>(replace: (revise: (revision: number) => void) => Promise<T>): Promise<T> {
    await this.waitUntilSent();
    this.isPaused = true;
    try {
      return await replace((revision) => {
        this.revision = Math.max(this.revision, revision);
        // The step that follows has the gains of the new levels.
        this.unsavedDoc = null;
      });
    } finally {
      this.isPaused = false;
      void this.send();
    }
  }

  get hasUnsavedStep(): boolean {
    return this.unsavedDoc !== null;
  }
}

function flushedRevisionKey(id: number): string {
  return `adwave-flushed-${id}`;
}

/** Fetches the stored edit; after a reload waits for the one that was flushed when the page was left. */
export async function fetchEditAfterReload(api: Api, id: number): Promise<Edit> {
  const flushed = Number(sessionStorage.getItem(flushedRevisionKey(id)));
  sessionStorage.removeItem(flushedRevisionKey(id));
  let edit = await api.edit(id);
  for (let tries = 0; edit.revision < flushed && tries < FLUSH_TRIES; tries++) {
    await new Promise((done) => setTimeout(done, 100));
    edit = await api.edit(id);
  }
  return edit;
}

/** Extracts the edit from the body of a conflict response. */
function conflictingEditOf(body: unknown): Edit | null {
  if (!body || typeof body !== 'object') return null;
  if ('layers' in body) return body as Edit;
  for (const value of Object.values(body)) {
    if (value && typeof value === 'object' && 'layers' in value) return value as Edit;
  }
  return null;
}
