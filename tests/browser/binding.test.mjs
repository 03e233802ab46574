// The WebAssembly module without the page: after a refusal every method refuses.

import assert from "node:assert/strict";
import { before, test } from "node:test";
import { openModel, predict } from "./support.mjs";

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
