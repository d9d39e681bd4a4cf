/** The worker, as promises. */

import type { Call, Calls, FromWorker, News } from './compute/messages';

export class Engine {
  private readonly worker: Worker;
  private readonly waiting = new Map<number, { done: (x: unknown) => void; failed: (e: Error) => void }>();
  private lastId = 0;

  constructor(
    worker: Worker,
    private readonly news: (news: News) => void,
  ) {
    this.worker = worker;
    worker.onmessage = (event: MessageEvent<FromWorker>) => {
      const message = event.data;
      if ('news' in message) {
        this.news(message);
        return;
      }
      const waiting = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if ('error' in message) waiting?.failed(new Error(message.error));
      else waiting?.done(message.answer);
    };
    worker.onerror = (event) => {
      for (const { failed } of this.waiting.values()) failed(new Error(event.message));
      this.waiting.clear();
    };
  }

  call<C extends Call>(call: C, what: Calls[C][0]): Promise<Calls[C][1]> {
    const id = ++this.lastId;
    return new Promise((done, failed) => {
      this.waiting.set(id, { done: done as (x: unknown) => void, failed });
      this.worker.postMessage({ id, call, with: what });
    });
  }
}
