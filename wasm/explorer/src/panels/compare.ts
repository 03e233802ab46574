import { button, html, type Root } from "../app/dom";
import { moveTo, PIN_NAMES, QUANTITIES, queryOf } from "../app/schema";
import type { Store } from "../app/store";
import type { Messages } from "../messages/en";
import type { Answer } from "../model/answer";
import { ERRORS, nameOf, unitOf, written } from "../model/quantities";
import type { Context, Trace, ViewPart } from "../views/view";

/** How long things must be at rest before the distances, which take all nodes of both shapes, are computed. */
const REST_MS = 120;

/** Pins queries, and shows the live one beside them: read-outs, differences, and whether the model resolves them. */
export class Compare implements ViewPart {
  readonly needs = [];
  readonly #store: Store;
  readonly #figure: HTMLElement;
  readonly #table: HTMLElement;
  readonly #pin: HTMLButtonElement;
  #resting = 0;
  /** The answers that the distances are of, and these once they are known. */
  #compared: readonly (Answer | undefined)[] = [];
  #far: readonly (Distance | undefined)[] | undefined;

  constructor(root: Root, store: Store) {
    this.#store = store;
    this.#figure = root.part("compare", HTMLElement);
    this.#table = root.part("compare-table", HTMLElement);
    this.#pin = root.part("pin", HTMLButtonElement);
    this.#pin.addEventListener("click", () => this.#add());
  }

  draw(traces: readonly Trace[], context: Context): void {
    const { pins } = context.state;
    this.#pin.disabled = pins.length === PIN_NAMES.length || traces[0]?.answer === undefined;
    this.#figure.hidden = pins.length === 0;
    if (pins.length === 0) {
      window.clearTimeout(this.#resting);
      this.#table.replaceChildren();
      this.#compared = [];
      return;
    }
    const answers = traces.map(({ answer }) => answer);
    if (answers.length !== this.#compared.length || answers.some((answer, i) => answer !== this.#compared[i])) {
      this.#compared = answers;
      this.#far = undefined;
      window.clearTimeout(this.#resting);
      this.#resting = window.setTimeout(() => {
        this.#far = distances(traces);
        this.#write(traces, context, this.#far);
      }, REST_MS);
    }
    this.#write(traces, context, this.#far);
  }

  #add(): void {
    const { state } = this.#store;
    const name = PIN_NAMES.find((free) => !state.pins.some((pin) => pin.name === free));
    if (name !== undefined) this.#store.set({ pins: [...state.pins, { name, ...queryOf(state) }] });
  }

  #write(traces: readonly Trace[], context: Context, far: readonly (Distance | undefined)[] | undefined): void {
    const { units, capsule, words } = context;
    const [live, ...pinned] = traces;
    const heads: HTMLElement[] = [
      html("th", { scope: "col", textContent: words.compare.readout }),
      html("th", { scope: "col", textContent: words.compare.live }),
    ];
    for (const trace of pinned) heads.push(this.#head(trace, capsule.names(), words));
    const rows = QUANTITIES.map((quantity) => {
      const own = live?.answer?.read(quantity);
      const name = `${nameOf(words, quantity, false)}, ${unitOf(quantity, units).name}`;
      const row = html("tr", {}, html("th", { scope: "row", textContent: name }));
      row.append(html("td", { textContent: own === undefined ? "–" : written(quantity, own, units) }));
      for (const { answer } of pinned) {
        const value = answer?.read(quantity);
        const cell = html("td", { textContent: value === undefined ? "–" : written(quantity, value, units) });
        if (value !== undefined && own !== undefined && !ERRORS.has(quantity)) {
          const difference = written(quantity, own - value, units);
          cell.append(html("small", { textContent: ` ${difference.startsWith("−") ? "" : "+"}${difference}` }));
        }
        row.append(cell);
      }
      return row;
    });
    const last = html("tr", {}, html("th", { scope: "row", textContent: words.compare.distance }), html("td"));
    pinned.forEach((_, i) => {
      const distance = far?.[i];
      const pending = far === undefined ? "…" : "–";
      const textContent = distance === undefined ? pending : inWords(distance, words.compare);
      last.append(html("td", { className: "distance", textContent }));
    });
    const table = html("table", {}, html("thead", {}, html("tr", {}, ...heads)), html("tbody", {}, ...rows, last));
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.pin : undefined;
    this.#table.replaceChildren(
      table,
      html("p", { className: "errors", textContent: words.compare.note(context.errors.against) }),
    );
    if (focused !== undefined) this.#table.querySelector<HTMLElement>(`[data-pin="${focused}"]`)?.focus();
  }

  #head({ name, query }: Trace, parameters: readonly string[], words: Messages): HTMLElement {
    const values = query.parameters.map((value, i) => `${parameters[i]} ${value}`).join(", ");
    const go = button(`${name}: ${values}, ${words.provenance.methods[query.method]}`, () => {
      this.#store.set({
        ...moveTo(this.#store.state, query.parameters),
        method: query.method,
        extrapolate: query.extrapolate,
      });
    });
    go.title = words.compare.makeLive(name);
    go.dataset.pin = `go ${name}`;
    const remove = button("×", () => {
      this.#store.set({ pins: this.#store.state.pins.filter((pin) => pin.name !== name) });
    });
    remove.ariaLabel = words.compare.remove(name);
    remove.dataset.pin = `remove ${name}`;
    return html("th", { scope: "col", className: `pin-${name}` }, go, remove);
  }
}

/** How far two shapes are apart, and the error that this is measured against, in the radius. */
export interface Distance {
  readonly distance: number;
  readonly error: number | undefined;
}

/** The distance of the live shape to each pinned one. */
export function distances([live, ...pinned]: readonly Trace[]): (Distance | undefined)[] {
  return pinned.map(({ answer }) => {
    if (live?.answer === undefined || answer === undefined) return undefined;
    const bounds = [live.answer, answer].map((one: Answer) => one.read("error_bound"));
    const error = bounds.some((bound) => bound === undefined)
      ? undefined
      : Math.max(...bounds.map((bound) => bound ?? 0));
    return { distance: live.answer.distance(answer) / live.radius, error };
  });
}

/** "1.2 % a: 12 times the error", or "not resolved" where the error is as large. */
export function inWords({ distance, error }: Distance, words: Messages["compare"]): string {
  const far = `${(100 * distance).toFixed(3)} % a`;
  if (distance === 0) return words.same(far);
  if (error === undefined) return words.noBound(far);
  const times = distance / error;
  return times <= 1
    ? words.notResolved(far)
    : words.times(far, times < 10 ? times.toFixed(1) : String(Math.round(times)));
}
