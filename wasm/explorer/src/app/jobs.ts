/** How long one frame may spend on what is computed beside it. */
const BUDGET_MS = 5;

/** Work in the gaps between frames: each job is a generator that yields after some tenths of a millisecond. */
export class Jobs {
  readonly #jobs = new Map<string, Generator<void>>();
  #frame = 0;

  /** Starts a job in place of the one of that name. */
  start(name: string, job: Generator<void>): void {
    this.#jobs.set(name, job);
    this.#request();
  }

  stop(name: string): void {
    this.#jobs.delete(name);
  }

  #request(): void {
    if (this.#frame === 0 && this.#jobs.size > 0) this.#frame = requestAnimationFrame(() => this.#work());
  }

  #work(): void {
    this.#frame = 0;
    const start = performance.now();
    while (performance.now() - start < BUDGET_MS) {
      const [next] = this.#jobs;
      if (next === undefined) break;
      const [name, job] = next;
      // In turn, so that no job waits for the end of another.
      this.#jobs.delete(name);
      if (job.next().done !== true) this.#jobs.set(name, job);
    }
    this.#request();
  }
}
