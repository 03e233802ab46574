import "./style/explorer.css";
import { Explorer, type Options } from "./app/explorer";
import { type Api, api, defineElement, setControls } from "./element";
import { keptLanguage, languageOf } from "./messages/languages";
import { keepOffline } from "./offline/keep";
import { loadFont } from "./style/font";

declare global {
  interface Window {
    /** The explorer of the page itself; `mount` puts another one into an element. */
    capsuleExplorer?: Api & { mount(element: HTMLElement, options: Options & { readonly prefix: string }): Api };
  }
}

/** The page CapsuleExplorer: its body is an explorer, and its address follows it. */
loadFont();
defineElement();
const words = new URLSearchParams(window.location.search);
const model = words.get("model");
// For a frame in another page.
setControls(document.body, words.get("controls"));
const language = languageOf(words.get("lang"), keptLanguage(), ...navigator.languages);
const explorer = new Explorer(document.body, {
  ownsAddress: true,
  language,
  ...(model === null ? {} : { model }),
});
explorer.root.speak(() => {
  document.documentElement.lang = explorer.root.language;
});
keepOffline(explorer.root.part("new-version", HTMLButtonElement));

window.capsuleExplorer = Object.defineProperties(
  {
    mount: (element: HTMLElement, options: Options & { readonly prefix: string }) =>
      api(new Explorer(element, options)),
  },
  Object.getOwnPropertyDescriptors(api(explorer)),
) as NonNullable<Window["capsuleExplorer"]>;
