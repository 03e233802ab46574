// The declarations of the package against the page's own types: the compiler refuses this file where they differ.

import type { State as PageState } from "../../explorer/src/app/schema";
import type { CapsuleExplorer, CONTROLS } from "../../explorer/src/element";
import type { CapsuleExplorerElement, Controls, State } from "./capsule-explorer";

type Flat<T> = { [K in keyof T]: T[K] };
type Same<A, B> = (<T>() => T extends A ? 1 : 2) extends <T>() => T extends B ? 1 : 2 ? true : never;

export const state: Same<Flat<State>, Flat<PageState>> = true;
export const controls: Same<Controls, (typeof CONTROLS)[number]> = true;
export const element = (real: CapsuleExplorer): CapsuleExplorerElement => real;
