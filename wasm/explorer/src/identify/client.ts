import type { Asked, Found, Question, Reply, Said } from "./protocol";

/** The worker's program could not be loaded, or it broke, with this message where there is one. */
export class ProgramError extends Error {}

/** The worker that identifies, seen from the page. It is started by the first question. */
export class Client {
  #worker: Worker | undefined;
  #opened = "";
  #count = 0;
  readonly #waiting = new Map<number, (reply: Reply) => void>();

  /** Opens a model unless it is open; `read` gives its bytes. */
  async open(digest: string, read: () => Uint8Array): Promise<void> {
    if (this.#opened === digest) return;
    this.#opened = digest;
    try {
      await this.#ask({ kind: "open", model: read() });
    } catch (error) {
      this.#opened = "";
      throw error;
    }
  }

  /** Throws an `Error` with the reason where the file is refused. */
  async identify(name: string, file: Uint8Array, said: Said): Promise<Found> {
    return (await this.#ask({ kind: "identify", name, file, said })) as Found;
  }

  /** Rises of the sum of squares at Ca, a/l, Ca, a/l, ... over that of the last answer. */
  async misfit(places: Float64Array): Promise<Float64Array> {
    return (await this.#ask({ kind: "misfit", places })) as Float64Array;
  }

  #ask(question: Question): Promise<Found | Float64Array | undefined> {
    const worker = this.#start();
    const asked: Asked = { id: ++this.#count, question };
    return new Promise((resolve, reject) => {
      const settle = (reply: Reply) => {
        if ("failed" in reply) reject(new ProgramError(reply.failed));
        else if ("refusal" in reply) reject(Object.assign(new Error(reply.refusal.words), reply.refusal));
        else resolve(reply.result);
      };
      this.#waiting.set(asked.id, settle);
      worker.postMessage(asked);
    });
  }

  #start(): Worker {
    if (this.#worker !== undefined) return this.#worker;
    const worker = new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
    worker.addEventListener("message", ({ data }: MessageEvent<Reply>) => {
      this.#waiting.get(data.id)?.(data);
      this.#waiting.delete(data.id);
    });
    // The program of the worker could not be loaded, or it broke: the next question starts another one.
    worker.addEventListener("error", (event) => {
      for (const [id, settle] of this.#waiting) settle({ id, failed: event.message });
      this.#waiting.clear();
      worker.terminate();
      this.#worker = undefined;
      this.#opened = "";
    });
    this.#worker = worker;
    return worker;
  }
}
