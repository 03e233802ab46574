/// <reference lib="esnext.disposable" preserve="true" />
import { type Evaluation, Model as Opened } from "./capsule_wasm.js";
import { asked, CapsuleError } from "./errors.js";
import { type Domain, type Method, Prediction } from "./prediction.js";

/** How a query is answered. */
export interface Options {
  /** The model's own method, if none is given. */
  readonly method?: Method;
  /** Answer outside the sampled domain too, without a bound of the error. */
  readonly extrapolate?: boolean;
}

/** A parameter of a model with the range in which it was sampled. */
export interface Parameter {
  readonly name: string;
  readonly min: number;
  readonly max: number;
}

/** What a model is. */
export interface Description {
  readonly title: string;
  /** CRC-32 in hexadecimal: identifies the model. */
  readonly digest: string;
  /** In the order of `predict`. */
  readonly parameters: readonly Parameter[];
  readonly units: { readonly length: string; readonly velocity: string; readonly time: string };
  /** The last instant that can be asked for; the first is 0. */
  readonly end_time: number;
  /** The method of a query that names none. */
  readonly method: Method;
  /** Constitutive law of the membrane in the full-order model. */
  readonly membrane_law: string;
  /** Bending stiffness in the full-order model, in G_s a^2; undefined where it is not known. */
  readonly bending_stiffness: number | undefined;
  /** The solution that errors are taken against, in words. */
  readonly errors_against: string;
  /** Nodes of the mesh. */
  readonly nodes: number;
}

/** A query as it was asked. */
interface Query {
  readonly parameters: Float64Array;
  readonly method: Method;
  readonly extrapolate: boolean;
}

/** Memory of a WebAssembly module. */
interface Part {
  free(): void;
}

/** The four triangles of a quadratic element, by its nodes: corners, then middles of the edges 12, 23 and 31. */
const PARTS = [0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5] as const;

/**
 * An opened model file; `load` opens one. It takes memory of the WebAssembly module, which `dispose` gives back at once
 * and the garbage collector some time after the model was last used. Predictions take none.
 */
export class Model {
  readonly #opened: Opened;
  readonly #evaluation: Evaluation;
  readonly #parts = new Map<unknown, Part>();
  /** The query that the evaluation is set to. */
  #set: Query | undefined;
  #isDisposed = false;

  /** @internal */
  constructor(bytes: Uint8Array) {
    this.#opened = asked(() => Opened.open(bytes));
    this.#evaluation = this.#opened.evaluation();
  }

  /** A capsule in the channel: capillary number Ca and confinement a/l. */
  predict(ca: number, confinement: number, options?: Options): Prediction;
  /** A model of other data: its parameters, in their order. */
  predict(parameters: readonly number[], options?: Options): Prediction;
  predict(first: number | readonly number[], second?: number | Options, third?: Options): Prediction {
    const [parameters, options] = typeof first === "number" ? [[first, Number(second)], third] : [first, second];
    const { method = this.#live().defaultMethod, extrapolate = false } = (options ?? {}) as Options;
    const query: Query = { parameters: Float64Array.from(parameters), method: method as Method, extrapolate };
    const domain = asked(() => this.#prepare(query));
    return new Prediction(domain, (question) =>
      asked(() => {
        this.#live();
        // The evaluation answers one query at a time: the one that it is set to, or the one that is asked now.
        if (this.#set !== query) this.#prepare(query);
        return question(this.#evaluation);
      }),
    );
  }

  /** What the model is. */
  describe(): Description {
    const model = this.#live();
    const ranges = model.ranges();
    const [length = "", velocity = "", time = ""] = model.units();
    return {
      title: model.title,
      digest: model.digest,
      parameters: model.parameterNames().map((name, i) => ({
        name,
        min: ranges[2 * i] ?? Number.NaN,
        max: ranges[2 * i + 1] ?? Number.NaN,
      })),
      units: { length, velocity, time },
      end_time: model.endTime,
      method: model.defaultMethod as Method,
      membrane_law: model.membraneLaw,
      bending_stiffness: model.bendingStiffness,
      errors_against: model.errorsAgainst,
      nodes: model.nodeCount,
    };
  }

  /** Triangles over the nodes, seen from outside counterclockwise: three nodes of one triangle after another. */
  triangles(): Uint32Array {
    const model = this.#live();
    const [elements, count] = [model.elements(), model.elementNodes];
    if (count === 3) return Uint32Array.from(elements);
    const { length } = PARTS;
    return Uint32Array.from({ length: (elements.length / count) * length }, (_, i) => {
      const node = PARTS[i % length] ?? 0;
      return elements[Math.floor(i / length) * count + node] ?? 0;
    });
  }

  /** The bytes of the file. */
  file(): Uint8Array {
    return this.#live().file();
  }

  /** Gives the memory back. The model and its predictions answer nothing more. */
  dispose(): void {
    if (this.#isDisposed) return;
    this.#isDisposed = true;
    for (const part of [...this.#parts.values(), this.#evaluation, this.#opened]) part.free();
  }

  [Symbol.dispose](): void {
    this.dispose();
  }

  /** What lives as long as the model, made from its file when it is first asked for. @internal */
  part<P extends Part>(make: (file: Uint8Array) => P): P {
    const model = this.#live();
    const known = this.#parts.get(make);
    if (known !== undefined) return known as P;
    const part = asked(() => make(model.file()));
    this.#parts.set(make, part);
    return part;
  }

  #live(): Opened {
    if (this.#isDisposed) throw new CapsuleError("disposed", "the model was disposed: load it again");
    return this.#opened;
  }

  #prepare(query: Query): Domain {
    this.#set = undefined;
    const domain = this.#evaluation.prepare(query.parameters, query.method, query.extrapolate);
    this.#set = query;
    return domain as Domain;
  }
}
