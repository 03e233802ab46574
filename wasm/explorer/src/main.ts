import "./style/theme.css";
import "./style/controls.css";
import "./style/map.css";
import "./style/figures.css";
import "./style/measured.css";
import "./style/panels.css";
import "./style/time.css";
import "./style/layout.css";
import "./style/model.css";
import "./style/sheets.css";
import "./style/tour.css";
import "./style/embedded.css";
import { Explorer, type Options } from "./app/explorer";
import { type Api, api, CapsuleExplorer, setControls } from "./element";
import { keepOffline } from "./offline/keep";
import { loadFont } from "./style/font";

declare global {
  interface Window {
    /** `mount` puts another explorer into an element of the page. */
    capsuleExplorer?: Api & { mount(element: HTMLElement, options: Options & { readonly prefix: string }): Api };
  }
}

loadFont();
const words = new URLSearchParams(window.location.search);
const model = words.get("model");
// For a frame in another page.
setControls(document.body, words.get("controls"));
const explorer = new Explorer(document.body, { ownsAddress: true, ...(model === null ? {} : { model }) });
keepOffline(explorer.root.part("new-version", HTMLButtonElement));
customElements.define("capsule-explorer", CapsuleExplorer);

window.capsuleExplorer = Object.defineProperties(
  {
    mount: (element: HTMLElement, options: Options & { readonly prefix: string }) =>
      api(new Explorer(element, options)),
  },
  Object.getOwnPropertyDescriptors(api(explorer)),
) as NonNullable<Window["capsuleExplorer"]>;
