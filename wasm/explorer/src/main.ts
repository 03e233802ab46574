import "./style/theme.css";
import "./style/controls.css";
import "./style/map.css";
import "./style/figures.css";
import "./style/panels.css";
import "./style/time.css";
import "./style/layout.css";
import "./style/model.css";
import "./style/sheets.css";
import { Explorer, type Options } from "./app/explorer";
import type { State } from "./app/schema";
import { loadFont } from "./style/font";

/** What scripts that drive or embed an explorer can do. */
interface Api {
  readonly state: State;
  /** Changes fields of the state; throws a `TypeError` for a value that cannot be one. */
  set(patch: Partial<State>): void;
  /** The query and the figures on screen. */
  read(): Record<string, number | string | boolean>;
}

declare global {
  interface Window {
    /** `mount` puts another explorer into an element of the page. */
    capsuleExplorer?: Api & { mount(element: HTMLElement, options: Options & { readonly prefix: string }): Api };
  }
}

function api({ store, workbench }: Explorer): Api {
  return {
    get state() {
      return store.state;
    },
    set: (patch) => store.set(patch),
    read: () => workbench.read(),
  };
}

loadFont();
const model = new URLSearchParams(window.location.search).get("model");
const explorer = new Explorer(document.body, { ownsAddress: true, ...(model === null ? {} : { model }) });

window.capsuleExplorer = Object.defineProperties(
  {
    mount: (element: HTMLElement, options: Options & { readonly prefix: string }) =>
      api(new Explorer(element, options)),
  },
  Object.getOwnPropertyDescriptors(api(explorer)),
) as NonNullable<Window["capsuleExplorer"]>;
