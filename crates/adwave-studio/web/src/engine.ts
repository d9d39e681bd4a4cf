/** Promise-based interface to the worker. */

import type { Call, Calls, FromWorker, WorkerEvent } from './compute/messages';

export class Engine {
  private readonly worker: Worker;
  private readonly pendingCalls = new Map<
    number,
    { done: (x: unknown) => void; failed: (e: Error) => void }
  >();
  private lastId = 0;

  constructor(
    worker: Worker,
    private readonly onEvent: (event: WorkerEvent) => void,
  ) {
    this.worker = worker;
    worker.onmessage = (event: MessageEvent<FromWorker>) => {
      const message = event.data;
      if ('event' in message) {
        this.onEvent(message);
        return;
      }
      const waiting = this.pendingCalls.get(message.id);
      this.pendingCalls.delete(message.id);
      if ('error' in message) waiting?.failed(new Error(message.error));
      else waiting?.done(message.answer);
    };
    worker.onerror = (event) => {
      for (const { failed } of this.pendingCalls.values()) failed(new Error(event.message));
      this.pendingCalls.clear();
    };
  }

  call<C extends Call>(call: C, what: Calls[C][0], transfer: Transferable[] = []): Promise<Calls[C][1]> {
    const id = ++this.lastId;
    return new Promise((done, failed) => {
      this.pendingCalls.set(id, { done: done as (x: unknown) => void, failed });
      this.worker.postMessage({ id, call, with: what }, transfer);
    });
  }
}
