/** Tells which figures are on screen, so that nothing is computed for the others. */
export class Visibility {
  readonly #seen = new Map<Element, boolean>();

  constructor(elements: Iterable<Element>, onAppear: () => void) {
    const observer = new IntersectionObserver(
      (entries) => {
        for (const entry of entries) this.#seen.set(entry.target, entry.isIntersecting);
        if (entries.some((entry) => entry.isIntersecting)) onAppear();
      },
      { rootMargin: "80px" },
    );
    for (const element of elements) {
      this.#seen.set(element, true);
      observer.observe(element);
    }
  }

  has(element: Element): boolean {
    return this.#seen.get(element) ?? false;
  }
}
