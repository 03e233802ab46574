export type { Source } from "./bytes.js";
export { CapsuleError } from "./errors.js";
export { load } from "./load.js";
export type { Description, Model, Options, Parameter } from "./model.js";
export type { Domain, Fields, Method, Observables, Plane, Prediction } from "./prediction.js";
