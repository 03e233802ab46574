import type { Root } from "../app/dom";
import { nameOf } from "../model/quantities";
import { type Course, type Courses, extremes, POINTS } from "../views/courses";
import type { Context, Trace, ViewPart } from "../views/view";
import { isControl } from "./transport";

/** The pitch of the least value in Hz, and the octaves from there to the greatest. */
const LOWEST = 220;
const OCTAVES = 2;
const SECONDS = 5;
const LOUDNESS = 0.15;

/** The curve along time as a sound: the pitch follows the value. It sounds when it is asked for. */
export class Sound implements ViewPart {
  readonly needs = [];
  readonly #courses: Courses;
  readonly #button: HTMLButtonElement;
  #course: Course | undefined;
  #sounding: { readonly course: Course; readonly oscillator: OscillatorNode } | undefined;
  #audio: AudioContext | undefined;

  constructor(root: Root, courses: Courses) {
    this.#courses = courses;
    this.#button = root.part("listen", HTMLButtonElement);
    this.#button.addEventListener("click", () => this.#toggle());
    root.element.addEventListener("keydown", (event) => {
      if (event.key.toLowerCase() !== "l" || event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.target === this.#button || !isControl(event.target)) this.#toggle();
    });
  }

  draw([live]: readonly Trace[], { state, words }: Context): void {
    this.#course = live && this.#courses.alongTime(live.name, live.query, state.trace, 1);
    if (this.#sounding !== undefined && this.#sounding.course !== this.#course) this.#stop();
    this.#button.disabled = this.#course?.done !== POINTS || extremes([this.#course]) === undefined;
    this.#button.ariaLabel = words.time.listen(nameOf(words, state.trace, false));
  }

  #toggle(): void {
    if (this.#sounding !== undefined) this.#stop();
    else if (this.#course !== undefined && !this.#button.disabled) this.#start(this.#course);
  }

  #start(course: Course): void {
    const [least, most] = extremes([course]) ?? [0, 1];
    const share = (value: number) => (most > least ? (value - least) / (most - least) : 0.5);
    this.#audio ??= new AudioContext();
    const oscillator = this.#audio.createOscillator();
    const gain = this.#audio.createGain();
    oscillator.connect(gain).connect(this.#audio.destination);
    const start = this.#audio.currentTime;
    // Where there is no value there is no sound, nor is there a click at the ends.
    let last = 0;
    const pitches = Float32Array.from(course.values, (value) => {
      if (!Number.isNaN(value)) last = share(value);
      return LOWEST * 2 ** (OCTAVES * last);
    });
    const loudness = Float32Array.from(course.values, (value, i) =>
      Number.isNaN(value) || i === 0 || i === POINTS - 1 ? 0 : LOUDNESS,
    );
    oscillator.frequency.setValueCurveAtTime(pitches, start, SECONDS);
    gain.gain.setValueCurveAtTime(loudness, start, SECONDS);
    oscillator.addEventListener("ended", () => {
      if (this.#sounding?.oscillator === oscillator) this.#stop();
    });
    oscillator.start(start);
    oscillator.stop(start + SECONDS);
    this.#sounding = { course, oscillator };
    this.#button.ariaPressed = "true";
  }

  #stop(): void {
    this.#sounding?.oscillator.disconnect();
    this.#sounding?.oscillator.stop();
    this.#sounding = undefined;
    this.#button.ariaPressed = "false";
  }
}
