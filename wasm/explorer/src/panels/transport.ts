import { element, html } from "../app/page";
import { SPEEDS, type State, type Store, VIEWS, type View } from "../app/state";
import { drawnUnit } from "../views/svg";
import { stepped, timeDigits } from "./time-axis";

const VIEW_NAMES: Record<View, string> = { solid: "3D", midplane: "z = 0", diagonal: "y = z", transversal: "x = c" };

/** Play, time, speed, choice of views, and the keys that work from anywhere on the page. */
export function tieTransport(store: Store): void {
  const play = element("play", HTMLButtonElement);
  const time = element("time-value", HTMLInputElement);
  const speed = element("speed", HTMLSelectElement);
  const section = element("section", HTMLInputElement);
  const initial = element("initial", HTMLInputElement);
  const views = viewButtons(store);

  const toggle = () => {
    const { playing, t, end } = store.state;
    store.set(playing ? { playing: false } : { playing: true, t: t >= end ? 0 : t });
  };
  play.addEventListener("click", toggle);
  time.addEventListener("input", () => {
    const t = time.valueAsNumber;
    if (t >= 0 && t <= store.state.end) store.set({ t, playing: false });
  });
  time.addEventListener("blur", () => show(store.state));
  speed.append(...SPEEDS.map((factor) => html("option", { value: String(factor), textContent: `${factor}×` })));
  speed.addEventListener("change", () => store.set({ speed: Number(speed.value) }));
  section.addEventListener("input", () => store.set({ section: section.valueAsNumber }));
  initial.addEventListener("change", () => store.set({ initial: initial.checked }));

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || isControl(event.target)) return;
    const { t, end } = store.state;
    const keys: Record<string, () => void> = {
      " ": toggle,
      ArrowRight: () => store.set({ t: stepped(t, event.shiftKey ? 10 : 1, end) }),
      ArrowLeft: () => store.set({ t: stepped(t, event.shiftKey ? -10 : -1, end) }),
      Home: () => store.set({ t: 0 }),
      End: () => store.set({ t: end }),
    };
    const action = keys[event.key];
    if (action !== undefined) {
      action();
      event.preventDefault();
    }
  });

  const plane = element("transversal-plane", HTMLElement);
  const show = (state: State) => {
    play.ariaPressed = String(state.playing);
    play.ariaLabel = state.playing ? "Pause" : "Play";
    time.max = String(state.end);
    if (document.activeElement !== time) time.value = state.t.toFixed(timeDigits(state.end));
    time.dataset.value = String(state.t);
    speed.value = String(state.speed);
    section.value = String(state.section);
    initial.checked = state.initial;
    plane.innerHTML = `<i class="symbol">x</i> = <i class="symbol">X</i><sub>c</sub> ${signed(state.section)} ${drawnUnit()}`;
    for (const [view, button] of views) {
      button.ariaPressed = String(state.views.has(view));
      document.querySelector(`figure[data-view="${view}"]`)?.toggleAttribute("hidden", !state.views.has(view));
    }
  };
  store.subscribe(show);
  show(store.state);
}

function viewButtons(store: Store): Map<View, HTMLButtonElement> {
  const buttons = new Map<View, HTMLButtonElement>();
  for (const view of VIEWS) {
    const button = html("button", { type: "button", textContent: VIEW_NAMES[view] });
    button.dataset.toggles = view;
    button.addEventListener("click", () => {
      const views = new Set(store.state.views);
      if (!views.delete(view)) views.add(view);
      store.set({ views: new Set(VIEWS.filter((name) => views.has(name))) });
    });
    buttons.set(view, button);
  }
  element("shown", HTMLFieldSetElement).append(...buttons.values());
  return buttons;
}

/** Whether the key belongs to the element that has the focus. */
function isControl(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest("input, select, button, textarea, [role=slider]") !== null;
}

function signed(value: number): string {
  return `${value < 0 ? "−" : "+"} ${Math.abs(value).toFixed(2)}`;
}
