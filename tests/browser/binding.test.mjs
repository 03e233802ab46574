// The WebAssembly module without the page: after a refusal every method refuses.

import assert from "node:assert/strict";
import { before, test } from "node:test";
import { openModel, predict, QUANTITIES } from "./support.mjs";

const QUESTIONS = {
  readings: (evaluation) => evaluation.readings(),
  volume: (evaluation) => evaluation.volume(),
  expectedError: (evaluation) => evaluation.expectedError(),
  errorBound: (evaluation) => evaluation.errorBound(),
  centroid: (evaluation) => evaluation.centroid(),
  outline: (evaluation) => evaluation.outline("midplane"),
  surface: (evaluation) => evaluation.surface(),
  transversal: (evaluation) => evaluation.transversal(0),
};

let model;

before(async () => {
  model = await openModel();
});

function assertAllRefused(evaluation, words) {
  for (const [name, ask] of Object.entries(QUESTIONS)) {
    assert.throws(() => ask(evaluation), words, name);
  }
}

test("nothing is answered before a query, nor after one that is refused", () => {
  const evaluation = model.evaluation();
  assertAllRefused(evaluation, /before a query was prepared/);
  for (const refused of [
    () => evaluation.prepare([0.9, 0.9], "direct", false),
    () => evaluation.prepare([0.1, 0.9], "guess", false),
    () => evaluation.prepare([], "direct", false),
    () => evaluation.prepare([0.1, 0.9, 1, 1, 1], "direct", false),
  ]) {
    assert.equal(evaluation.prepare([0.1, 0.9], "direct", false), "inside");
    evaluation.goTo(3);
    assert.ok(evaluation.volume() > 0);
    assert.throws(refused);
    assertAllRefused(evaluation, /before a query was prepared/);
  }
});

for (const method of ["direct", "paper"]) {
  test(`a shape that no capsule can have is refused by every question, by the method ${method}`, () => {
    const evaluation = model.evaluation();
    assert.equal(evaluation.prepare([0.15, 1.1], method, true), "beyond-steady-limit");
    evaluation.goTo(20);
    assertAllRefused(evaluation, /no capsule has the extrapolated shape/);
  });
}

test("a bound is there inside the domain only", () => {
  const evaluation = model.evaluation();
  evaluation.goTo(3);
  evaluation.prepare([0.1, 0.9], "direct", false);
  assert.equal(evaluation.errorBound(), Math.fround(predict(0.1, 0.9, [3], "direct").instants[0].error_bound));
  evaluation.prepare([0.13, 0.95], "direct", true);
  assert.ok(evaluation.expectedError() > 0);
  assert.equal(evaluation.errorBound(), undefined);
});

test("many answers in one call are those of one after another", () => {
  const evaluation = model.evaluation();
  evaluation.prepare([0.1, 0.9], "direct", false);
  const times = [0.5, 3, 20];
  const { instants } = predict(0.1, 0.9, times, "direct");
  for (const quantity of ["axial_length", "volume", "expected_error", "error_bound"]) {
    const course = [...evaluation.course(quantity, Float32Array.from(times))];
    assert.deepEqual(
      course,
      instants.map((instant) => Math.fround(instant[quantity])),
      quantity,
    );
  }
  evaluation.goTo(3);
  const expected = QUANTITIES.map((quantity) => Math.fround(instants[1][quantity]));
  assert.deepEqual([...evaluation.readouts()].slice(0, 8), expected);
  const grid = evaluation.grid("velocity", Float64Array.of(0.1, 0.9, 0.9, 0.9, 0.05, 0.8), 2, 3, "direct");
  const other = predict(0.05, 0.8, [3], "direct").instants[0];
  assert.deepEqual([...grid], [Math.fround(instants[1].velocity), Number.NaN, Math.fround(other.velocity)]);
  assert.throws(() => evaluation.course("colour", Float32Array.of(1)), /read-out "colour" is unknown/);
});

test("the distance of two shapes is none to itself and the same both ways", () => {
  const [one, other] = [model.evaluation(), model.evaluation()];
  for (const [evaluation, ca] of [
    [one, 0.1],
    [other, 0.1],
  ]) {
    evaluation.prepare([ca, 0.9], "direct", false);
    evaluation.goTo(3);
  }
  assert.equal(one.distance(other), 0);
  other.prepare([0.08, 0.9], "direct", false);
  assert.equal(one.distance(other), other.distance(one));
  // The drift alone moves every node by as much as the centroid: no node is nearer than the shapes allow.
  const drift = Math.abs(one.centroid() - other.centroid());
  assert.ok(one.distance(other) > 0 && one.distance(other) < drift + 0.1);
});
