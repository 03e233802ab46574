import type { Root } from "../app/dom";
import type { Jobs } from "../app/jobs";
import type { View } from "../app/schema";
import type { Store } from "../app/store";
import { Measured } from "../identify/measured";
import { Calculator } from "../panels/calculator";
import { Compare } from "../panels/compare";
import { MapChoices } from "../panels/map-choices";
import { MeasuredView } from "../panels/measured";
import { Notice } from "../panels/notice";
import { Readouts } from "../panels/readouts";
import { ParameterSliders } from "../panels/sliders";
import { Sound } from "../panels/sound";
import { TimeAxis } from "../panels/time-axis";
import { Transport } from "../panels/transport";
import { Courses } from "./courses";
import { Longitudinal } from "./longitudinal";
import { ParameterMap } from "./map";
import { Plots } from "./plots";
import { SolidView } from "./solid-view";
import { Transversal } from "./transversal";
import type { ViewPart } from "./view";

/** The parts of an explorer. A new one is added here; nothing else needs to know of it. */
export interface Parts {
  /** What can be opened and closed, each in a figure of the markup. */
  readonly views: Readonly<Record<View, ViewPart>>;
  /** What is always on screen, in the order in which it is drawn. */
  readonly panels: readonly ViewPart[];
  readonly courses: Courses;
  /** The space view, for what only it can do. */
  readonly solid: SolidView;
  readonly measured: Measured;
}

/** Makes the parts of an explorer. `redraw` asks for another frame; `open` takes a file of the user's. */
export function makeParts(root: Root, store: Store, jobs: Jobs, redraw: () => void, open: (file: File) => void): Parts {
  const measured = new Measured(redraw);
  const courses = new Courses(jobs, redraw);
  const onSection = (section: number) => store.set({ section: Math.min(5, Math.max(-5, section)) });
  const solid = new SolidView(root, store);
  const map = new ParameterMap(root, measured, (point) => store.set({ ...point, extrapolate: false }));
  return {
    courses,
    solid,
    measured,
    views: {
      solid,
      midplane: new Longitudinal(root, "midplane", onSection, measured),
      diagonal: new Longitudinal(root, "diagonal", onSection),
      transversal: new Transversal(root),
      plots: new Plots(root, store, courses),
      measured: new MeasuredView(root, store, measured, open),
    },
    panels: [
      measured,
      new ParameterSliders(root, (parameters) => store.set({ parameters, extrapolate: false })),
      new MapChoices(root, store, map, measured, jobs, redraw),
      map,
      new Notice(root, store),
      new Readouts(root, (trace) => store.set({ trace })),
      new TimeAxis(root, store, courses),
      new Sound(root, courses),
      new Transport(root, store),
      new Compare(root, store),
      new Calculator(root, store),
    ],
  };
}
