import { button, html, type Root } from "../app/dom";
import { CAMERAS, type Camera, CLIPS, COLOURS, type State } from "../app/schema";
import type { Store } from "../app/store";
import type { Capsule } from "../model/capsule";
import { isMechanics } from "../model/fields";

/** The choices above the space view: colours, a plane to cut the capsule open, and where it is seen from. */
export class SolidControls {
  readonly #colour: HTMLSelectElement;
  readonly #clip: HTMLSelectElement;

  /** `look` is called for each press of a camera's button or key, also where the state has that camera already. */
  constructor(root: Root, store: Store, look: (from: Camera) => void) {
    this.#colour = root.part("colour", HTMLSelectElement);
    this.#clip = root.part("clip", HTMLSelectElement);
    const colours = COLOURS.map((value) => html("option", { value }));
    const clips = CLIPS.map((value) => html("option", { value }));
    this.#colour.append(...colours);
    this.#clip.append(...clips);
    this.#colour.addEventListener("change", () => {
      const colour = COLOURS.find((value) => value === this.#colour.value);
      // A scale that is held is one of the field before.
      if (colour !== undefined) store.set({ colour, range: [] });
    });
    this.#clip.addEventListener("change", () => {
      const clip = CLIPS.find((value) => value === this.#clip.value);
      if (clip !== undefined) store.set({ clip });
    });
    const go = (camera: Camera) => {
      store.set({ camera });
      look(camera);
    };
    const buttons = CAMERAS.map((camera, i) => {
      const made = button("", () => go(camera));
      made.setAttribute("aria-keyshortcuts", String(i + 1));
      return made;
    });
    root.part("cameras", HTMLElement).append(...buttons);
    root.speak(({ space, fields }) => {
      for (const [i, colour] of COLOURS.entries()) {
        colours[i]?.replaceChildren(colour === "none" ? space.colours.none : fields[colour]);
      }
      for (const [i, clip] of CLIPS.entries()) clips[i]?.replaceChildren(space.clips[clip]);
      for (const [i, camera] of CAMERAS.entries()) {
        buttons[i]?.replaceChildren(space.cameras[camera]);
        buttons[i]?.setAttribute("title", space.look(i + 1));
      }
    });
    root.element.addEventListener("keydown", (event) => {
      const isTyped = event.target instanceof Element && event.target.closest("input, select, dialog") !== null;
      if (event.ctrlKey || event.altKey || event.metaKey || isTyped) return;
      const camera = CAMERAS[Number(event.key) - 1];
      if (camera !== undefined) go(camera);
    });
  }

  draw({ colour, clip }: State, capsule: Capsule): void {
    this.#colour.value = colour;
    this.#clip.value = clip;
    for (const option of this.#colour.options) {
      const field = COLOURS.find((value) => value === option.value) ?? "none";
      option.hidden = field !== "none" && isMechanics(field) && !capsule.has("mechanics");
    }
  }
}
