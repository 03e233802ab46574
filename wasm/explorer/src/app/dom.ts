/** An element of the document that holds one explorer. Its parts are looked up inside it and nowhere else. */
export class Root {
  readonly element: HTMLElement;
  /** Stands before each id, so that the ids of two explorers on one page differ. */
  readonly prefix: string;

  /** Puts the markup into the element. */
  constructor(element: HTMLElement, prefix: string, markup: string) {
    this.element = element;
    this.prefix = prefix;
    element.classList.add("explorer");
    element.insertAdjacentHTML("beforeend", prefix === "" ? markup : prefixed(markup, prefix));
  }

  /** The id that a part has in the document. */
  id(name: string): string {
    return `${this.prefix}${name}`;
  }

  /** Finds a part that the markup promises. */
  part<T extends Element>(name: string, type: new (...args: never[]) => T): T {
    const found = this.element.querySelector(`[id="${this.id(name)}"]`);
    if (!(found instanceof type)) throw new Error(`the markup has no ${type.name} with id "${name}"`);
    return found;
  }

  all<T extends Element>(selector: string): T[] {
    return [...this.element.querySelectorAll<T>(selector)];
  }
}

/** The markup with the prefix before each id and before each reference to one. */
function prefixed(markup: string, prefix: string): string {
  return markup.replace(
    /\b(id|for|name|aria-labelledby|aria-describedby|aria-controls)="([^"]+)"/g,
    (_, attribute: string, ids: string) =>
      `${attribute}="${ids
        .split(" ")
        .map((id) => prefix + id)
        .join(" ")}"`,
  );
}

/** Makes an HTML element with properties and children. */
export function html<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** Makes a button that runs something. */
export function button(label: string, run: () => void): HTMLButtonElement {
  const made = html("button", { type: "button", textContent: label });
  made.addEventListener("click", run);
  return made;
}
