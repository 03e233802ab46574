import "@fontsource-variable/ibm-plex-sans/wght.css";
import "@fontsource/stix-two-text/latin-400-italic.css";
import "@fontsource/stix-two-text/latin-ext-400-italic.css";
import "./style/theme.css";
import "./style/controls.css";
import "./style/map.css";
import "./style/figures.css";
import "./style/panels.css";
import "./style/time.css";
import "./style/layout.css";
import "./style/model.css";
import { fromFragment, toFragment } from "./app/link";
import { element, html } from "./app/page";
import { DEFAULT_STATE, METHODS, type State, Store } from "./app/state";
import { Workbench } from "./app/workbench";
import { Capsule, ModelError, text } from "./model/capsule";
import { describe } from "./panels/model-card";

declare global {
  interface Window {
    /** For scripts that drive or embed the page: the state, a way to change it, and the figures on screen. */
    capsuleExplorer?: {
      readonly state: State;
      set(patch: Partial<State>): void;
      read(): Record<string, number | string | boolean>;
    };
  }
}

const SHIPPED = "./capsule.crom";

const store = new Store({ ...DEFAULT_STATE, ...fromFragment(window.location.hash) });
const workbench = new Workbench(store);
const failure = element("failure", HTMLElement);
const picker = element("model-file", HTMLInputElement);
let isOpen = false;

window.capsuleExplorer = {
  get state() {
    return store.state;
  },
  set: (patch) => store.set(patch),
  read: () => workbench.read(),
};

element("open-model", HTMLButtonElement).addEventListener("click", () => picker.click());
picker.addEventListener("change", async () => {
  const [file] = picker.files ?? [];
  picker.value = "";
  await open(file);
});
takeDropped();
tieLink();
const address = new URLSearchParams(window.location.search).get("model") ?? SHIPPED;
await show(Capsule.fetch(new URL(address, window.location.href)));

/** Shows a model, or why there is none. */
async function show(opening: Promise<Capsule>): Promise<void> {
  try {
    const capsule = await opening;
    // A link says which method it means; without one the model's own choice holds.
    if (!isOpen && fromFragment(window.location.hash).method === undefined) {
      store.set({ method: METHODS.find((method) => method === capsule.model.defaultMethod) ?? DEFAULT_STATE.method });
    }
    workbench.open(capsule);
    describe(element("model", HTMLElement), capsule);
    isOpen = true;
    resume();
  } catch (error) {
    fail(error);
  }
}

/** Opens a file of the user's, if there is one. */
async function open(file: File | undefined): Promise<void> {
  if (file !== undefined) {
    await show(Capsule.open(new Uint8Array(await file.arrayBuffer()), file.name));
  }
}

/** A file dropped anywhere on the page is opened; without this a browser would leave the page for it. */
function takeDropped(): void {
  const over = (isOver: boolean) => document.body.toggleAttribute("data-dropping", isOver);
  window.addEventListener("dragover", (event) => {
    if (event.dataTransfer?.types.includes("Files")) {
      event.preventDefault();
      over(true);
    }
  });
  window.addEventListener("dragleave", (event) => {
    if (event.relatedTarget === null) over(false);
  });
  window.addEventListener("drop", async (event) => {
    if (event.dataTransfer?.types.includes("Files")) {
      event.preventDefault();
      over(false);
      await open(event.dataTransfer.files[0]);
    }
  });
}

function resume(): void {
  failure.hidden = true;
  document.body.dataset.status = "ready";
}

function fail(error: unknown): void {
  const known = error instanceof ModelError;
  const title = known ? error.message : `The page could not start: ${text(error)}.`;
  const remedy = known
    ? error.remedy
    : "Load the page again; if that does not help, build it with `cargo xtask explore`.";
  failure.replaceChildren(html("h2", { textContent: title }), html("p", {}, ...withCode(remedy)));
  if (isOpen) {
    const back = html("button", { type: "button", textContent: "Back to the model that is open" });
    back.addEventListener("click", resume);
    failure.append(back);
  }
  failure.hidden = false;
  document.body.dataset.status = "failed";
}

/** The address always restores what is seen: it follows the state, and the state follows it. */
function tieLink(): void {
  let pending = 0;
  store.subscribe((state) => {
    if (state.playing) return;
    window.clearTimeout(pending);
    pending = window.setTimeout(() => history.replaceState(null, "", toFragment(state)), 150);
  });
  window.addEventListener("hashchange", () => {
    const wanted = fromFragment(window.location.hash);
    store.set({ ...wanted, t: Math.min(Math.max(wanted.t ?? store.state.t, 0), store.state.end), playing: false });
  });
  const button = element("copy-link", HTMLButtonElement);
  button.addEventListener("click", async () => {
    history.replaceState(null, "", toFragment(store.state));
    try {
      await navigator.clipboard.writeText(window.location.href);
      button.textContent = "Copied";
    } catch {
      button.textContent = "Copy it from the address bar";
    }
    window.setTimeout(() => {
      button.textContent = "Copy link";
    }, 2000);
  });
}

/** Sets what stands between backquotes as code. */
function withCode(words: string): (Node | string)[] {
  return words.split("`").map((part, i) => (i % 2 === 1 ? html("code", { textContent: part }) : part));
}
