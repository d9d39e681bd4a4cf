/** Sends the edit to the server after each step, tries again while there is no server, and knows what is kept there. */

import { type Api, ApiError } from './api';
import type { Edit, Moved } from './protocol';
import { type Doc, toEdit } from './state';

/** `ended`: the server is another run than the one that this page was opened by. */
export type SaveState = 'kept' | 'sending' | 'offline' | 'ended' | 'conflict' | 'refused';

/** Milliseconds between tries while there is no server. */
const RETRY = 1500;
/** Milliseconds that a step waits for the picture at the most. */
const PICTURE_FIRST = 400;
/** Bytes that a browser sends while the page is being closed. */
const KEEPALIVE_LIMIT = 60_000;
/** Tenths of a second to wait for it after a reload. */
const FLUSH_TRIES = 15;

export class Saver {
  state: SaveState = 'kept';
  problem = '';
  /** What is kept on the server in place of ours, where another page was faster. */
  theirs: Edit | null = null;
  private wanted: Doc | null = null;
  private sending = false;
  private retry = 0;
  private closed = false;
  private held = false;

  constructor(
    private readonly api: Api,
    private readonly id: number,
    private revision: number,
    private readonly told: (moved: Moved | null) => void,
  ) {}

  /** A step, sent once `shown` resolves: the server computes with all processors, which the picture needs first. */
  changed(doc: Doc, shown: Promise<void>): void {
    this.wanted = doc;
    if (this.state === 'kept') this.set('sending');
    void Promise.race([shown, new Promise((done) => setTimeout(done, PICTURE_FIRST))]).then(() =>
      this.send(),
    );
  }

  private set(state: SaveState, problem = ''): void {
    this.state = state;
    this.problem = problem;
  }

  async send(): Promise<void> {
    if (this.sending || !this.wanted || this.state === 'conflict' || this.closed || this.held) return;
    window.clearTimeout(this.retry);
    const doc = this.wanted;
    this.sending = true;
    if (this.state !== 'offline') this.set('sending');
    this.told(null);
    try {
      const moved = await this.api.putEdit(this.id, toEdit(doc, ++this.revision));
      this.sending = false;
      if (this.closed) return;
      if (this.wanted === doc) {
        this.wanted = null;
        this.set('kept');
        this.told(moved);
      } else {
        this.set('sending');
        await this.send();
      }
    } catch (error) {
      this.sending = false;
      if (this.closed) return;
      if (error instanceof ApiError && error.status === 409) {
        this.theirs = keptEdit(error.body);
        if (this.theirs) this.revision = Math.max(this.revision, this.theirs.revision);
        this.set('conflict', error.message);
      } else if (error instanceof ApiError && error.status === 401) {
        this.set('ended', error.message);
      } else if (error instanceof ApiError && error.status > 0) {
        // The same document again would be refused again: wait for the next step.
        this.wanted = null;
        this.set('refused', error.message);
      } else {
        this.set('offline', error instanceof Error ? error.message : String(error));
        this.retry = window.setTimeout(() => void this.send(), RETRY);
      }
      this.told(null);
    }
  }

  /** Resolves when the server has the edit, or cannot have it now. */
  async sent(): Promise<void> {
    await this.send();
    while (this.state === 'sending' && !this.closed) await new Promise((done) => setTimeout(done, 20));
  }

  /** Ends a conflict: ours replaces what is kept, or theirs is taken. */
  resolve(keepOurs: boolean): void {
    if (this.state !== 'conflict') return;
    this.set(keepOurs ? 'sending' : 'kept');
    if (keepOurs) void this.send();
    else this.wanted = null;
  }

  /** The page is being closed: what is not kept yet goes along. */
  flush(): void {
    if (!this.wanted) return;
    const edit = toEdit(this.wanted, ++this.revision);
    sessionStorage.setItem(flushedKey(this.id), String(this.revision));
    if (JSON.stringify(edit).length < KEEPALIVE_LIMIT)
      void this.api.putEdit(this.id, edit, true).catch(() => {});
  }

  close(): void {
    this.flush();
    this.leave();
  }

  /** Another takes over, with what the server has now. */
  leave(): void {
    this.wanted = null;
    this.closed = true;
    window.clearTimeout(this.retry);
  }

  /** Sends nothing while the server replaces the edit: what the page changes meanwhile belongs to the one that goes. */
  async whileReplaced<T>(replace: () => Promise<T>): Promise<T> {
    await this.sent();
    this.held = true;
    try {
      return await replace();
    } finally {
      this.held = false;
      void this.send();
    }
  }

  get pending(): boolean {
    return this.wanted !== null;
  }
}

function flushedKey(id: number): string {
  return `adwave-flushed-${id}`;
}

/** The edit that is kept; after a reload the one that was on its way when the page was left. */
export async function keptAfterReload(api: Api, id: number): Promise<Edit> {
  const flushed = Number(sessionStorage.getItem(flushedKey(id)));
  sessionStorage.removeItem(flushedKey(id));
  let edit = await api.edit(id);
  for (let tries = 0; edit.revision < flushed && tries < FLUSH_TRIES; tries++) {
    await new Promise((done) => setTimeout(done, 100));
    edit = await api.edit(id);
  }
  return edit;
}

/** The edit within the answer to one that came too late: alone, or beside its sentence. */
function keptEdit(body: unknown): Edit | null {
  if (!body || typeof body !== 'object') return null;
  if ('layers' in body) return body as Edit;
  for (const value of Object.values(body)) {
    if (value && typeof value === 'object' && 'layers' in value) return value as Edit;
  }
  return null;
}
