// SPDX-License-Identifier: MIT
// Asks the thread of worker.js, so that a step of dragging does not keep the page.

export class Background {
  /** From the address of its script. */
  constructor(url) {
    this.worker = new Worker(url);
    this.asked = new Map(); // what to do with each answer
    this.waiting = new Map(); // of each slot whose question is under way: the next one, or null
    this.number = 0;
    this.worker.onmessage = ({ data: { number, answer, error } }) => {
      const { take, refuse } = this.asked.get(number);
      this.asked.delete(number);
      if (error === undefined) take(answer);
      else refuse(new Error(error));
    };
  }

  /** The answer of a task of worker.js. */
  ask(task, given) {
    this.worker.postMessage({ number: ++this.number, task, given });
    return new Promise((take, refuse) => this.asked.set(this.number, { take, refuse }));
  }

  /** The same, but of all questions of a slot that come while one is under way only the last is asked: the others are answered
   * by undefined. */
  async latest(slot, task, given) {
    if (this.waiting.has(slot)) {
      this.waiting.get(slot)?.(false);
      if (!(await new Promise((go) => this.waiting.set(slot, go)))) return undefined;
    } else {
      this.waiting.set(slot, null);
    }
    try {
      return await this.ask(task, given);
    } finally {
      const next = this.waiting.get(slot);
      if (next) this.waiting.set(slot, null); // before the next question goes on: one that comes now waits for it
      else this.waiting.delete(slot);
      next?.(true);
    }
  }
}
