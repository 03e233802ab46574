// The package capsule-rom in Node, from its archive: the numbers of the command, its refusals, its memory, its types.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { describe, test } from "node:test";
import {
  identify as byCommand,
  HALF_WIDTH_UM,
  picture,
  pointsText,
  section,
} from "../../../tests/browser/outlines.mjs";
import { MODEL, predict, predictFields } from "../../../tests/browser/support.mjs";
import { archives, examples, project, run, TSC } from "./support.mjs";

const { folder, written, imported } = project();
const { CapsuleError, load } = await imported("capsule-rom");
const { identify } = await imported("capsule-rom/identify");
const model = await load();

const POINTS = await section(0.06, 0.95);
const TEXT = pointsText(POINTS);
const SETUP = { half_width_um: HALF_WIDTH_UM, velocity_mm_s: 5, viscosity_pa_s: 0.8 };

/** Throws a refusal of this code whose words match. */
function assertRefused(ask, code, words) {
  const isIt = (error) => {
    assert.ok(error instanceof CapsuleError && error instanceof Error, String(error));
    assert.equal(error.name, "CapsuleError");
    assert.equal(error.code, code, error.message);
    assert.match(error.message, words);
    return true;
  };
  return ask instanceof Promise ? assert.rejects(ask, isIt) : assert.throws(ask, isIt);
}

describe("predictions have the bits of the command", () => {
  for (const [ca, confinement, method, extrapolate] of [
    [0.06, 0.97, "direct", false],
    [0.06, 0.97, "paper", false],
    [0.13, 0.95, "direct", true],
  ]) {
    test(`at ${ca}, ${confinement} by the method ${method}`, () => {
      const capsule = model.predict(ca, confinement, { method, extrapolate });
      const expected = predict(ca, confinement, [0, 0.4, 3, 8], method, extrapolate);
      assert.equal(capsule.domain, expected.domain);
      for (const { t, volume, expected_error, error_bound, ...observables } of expected.instants) {
        const { centroid, ...found } = capsule.observables(t);
        assert.deepEqual(found, singles(observables));
        assert.equal(capsule.volume(t), Math.fround(volume));
        assert.equal(capsule.expectedError(t), Math.fround(expected_error));
        assert.equal(capsule.bound(t), error_bound === null ? undefined : Math.fround(error_bound));
      }
    });
  }

  test("at the nodes", () => {
    const capsule = model.predict(0.05, 0.9);
    const { t, node, ...expected } = predictFields(0.05, 0.9, 5, "direct");
    const columns = (name, vectors) =>
      [..."xyz"].map((axis, i) => [name + axis, vectors.filter((_, component) => component % 3 === i)]);
    const fields = Object.entries(capsule.fields(5)).flatMap(([name, values]) =>
      values.length === node.length ? [[name, values]] : columns(`${name}_`, values),
    );
    const motion = [...columns("", capsule.positions(5)), ...columns("velocity_", capsule.velocities(5))];
    assert.deepEqual(Object.fromEntries([...motion, ...fields]), expected);
  });

  test("of the model", () => {
    const { digest, units, errors_against, method, parameters, nodes } = model.describe();
    const expected = predict(0.1, 0.9, [1], method);
    assert.deepEqual([digest, units, errors_against], [expected.model_digest, expected.units, expected.errors_against]);
    assert.deepEqual(
      parameters.map(({ name }) => name),
      Object.keys(expected.parameters).sort(),
    );
    assert.equal(3 * nodes, model.predict(0.1, 0.9).positions(1).length);
    assert.deepEqual(Buffer.from(model.file()), readFileSync(MODEL));
  });
});

/** Numbers of the command as the single precision that they are. */
function singles(numbers) {
  return Object.fromEntries(Object.entries(numbers).map(([name, value]) => [name, Math.fround(value)]));
}

describe("shapes fit together", () => {
  const capsule = model.predict(0.1, 0.9);
  const positions = capsule.positions(3);
  const nodes = Array.from({ length: positions.length / 3 }, (_, i) => positions.subarray(3 * i, 3 * i + 3));
  const pairs = (flat) => Array.from({ length: flat.length / 2 }, (_, i) => flat.subarray(2 * i, 2 * i + 2));

  test("triangles enclose the volume", () => {
    const corners = [...model.triangles()].map((node) => nodes[node]);
    let six = 0;
    for (let i = 0; i < corners.length; i += 3) {
      const [[a, b, c], [d, e, f], [g, h, k]] = corners.slice(i, i + 3);
      six += a * (e * k - f * h) + b * (f * g - d * k) + c * (d * h - e * g);
    }
    // Flat triangles cut off a little.
    const share = six / 6 / capsule.volume(3);
    assert.ok(share > 0.99 && share < 1.001, `${share} of the volume`);
  });

  test("the centroid moves at the velocity", () => {
    const [before, now, after] = [2.99, 3, 3.01].map((t) => capsule.observables(t));
    assert.ok(Math.abs((after.centroid - before.centroid) / 0.02 - now.velocity) < 2e-3);
  });

  test("outlines lie on nodes of their planes", () => {
    for (const [plane, isIn] of [
      ["midplane", ([, , z]) => z === 0],
      ["diagonal", ([, y, z]) => Math.abs(y - z) < 1e-6],
    ]) {
      const candidates = nodes.filter(isIn).map(([x, y, z]) => [x, Math.hypot(y, z)]);
      for (const [x, r] of pairs(capsule.outline(plane, 3))) {
        const apart = Math.min(...candidates.map(([a, b]) => Math.hypot(a - x, b - r)));
        assert.ok(apart < 1e-5, `${plane}: ${x}, ${r} is ${apart} from the nearest node`);
      }
    }
  });

  test("a silhouette holds all nodes, and touches the outermost", () => {
    for (const angle of [0, 0.3, Math.PI / 4]) {
      const seen = pairs(capsule.silhouette(3, angle, 1001));
      assert.equal(seen.length, 1001);
      const across = nodes.map(([x, y, z]) => [x, Math.cos(angle) * y + Math.sin(angle) * z]);
      for (const axis of [0, 1]) {
        const [own, other] = [seen, across].map((points) => Math.max(...points.map((point) => point[axis])));
        assert.ok(Math.abs(own - other) < 2e-3, `angle ${angle}: ${own}, of the nodes ${other}`);
      }
    }
    assert.equal(capsule.silhouette(3).length, 2 * 257);
  });
});

describe("an identification is that of the command", () => {
  test("from a text, its bytes and its points", async () => {
    const expected = byCommand(written("outline.csv", TEXT));
    const setup = { ...SETUP, observable: "midplane" };
    const found = await identify(model, TEXT, setup);
    assert.deepEqual(found.answer, expected);
    assert.equal(found.contour.length, POINTS.length);
    const bytes = await identify(model, new TextEncoder().encode(TEXT), setup);
    assert.deepEqual(bytes, found);
    const numbers = TEXT.trim().split("\n").slice(1);
    const points = numbers.map((line) => line.split(",").map(Number));
    // How the points were written is said in words.
    const { contour, ...answer } = (await identify(model, points, setup)).answer;
    assert.deepEqual(answer, (({ contour: _, ...rest }) => rest)(expected));
    assert.match(contour, new RegExp(`^${POINTS.length} points`));
    const rate = await identify(model, TEXT, { ...setup, velocity_mm_s: undefined, flow_rate_ul_min: 0.75 });
    assert.equal(rate.answer.mean_velocity_mm_s.toFixed(9), "5.000000000");
  });

  test("from a picture, with options", async () => {
    const png = picture(POINTS, 30, [150, 80]);
    const file = written("picture.png", png);
    const expected = byCommand(file, ["-o", "midplane", "--channel", "square", "--flow", "right", "--edge-px", "0.5"]);
    const setup = { ...SETUP, observable: "midplane", flow: "right", edge_px: 0.5 };
    // Logarithms of the brightness are the system's, and may differ in the last bit.
    const rounded = (_, value) => (typeof value === "number" ? Number(value.toPrecision(9)) : value);
    const [found, wanted] = [(await identify(model, png, setup)).answer, expected].map((answer) =>
      JSON.parse(JSON.stringify(answer, rounded)),
    );
    assert.deepEqual(found, wanted);
    assert.equal(found.picture.capsules, 1);
  });
});

describe("refusals name what is wrong", () => {
  test("of a query", () => {
    assertRefused(() => model.predict(0.9, 0.9), "outside-domain", /capillary_number = 0.9 lies outside .* range/);
    assertRefused(() => model.predict(Number.NaN, 0.9), "parameter", /capillary_number is NaN/);
    assertRefused(() => model.predict(0.1), "parameter", /confinement is NaN/);
    assertRefused(() => model.predict([0.1]), "parameter-count", /2 parameters, the query 1/);
    assertRefused(() => model.predict(0.1, 0.9, { method: "guess" }), "unknown-name", /"guess" is unknown/);
    const capsule = model.predict(0.1, 0.9);
    assertRefused(() => capsule.observables(1000), "value", /is 1000, it must be in \[0, 20\]/);
    assertRefused(() => capsule.outline("equator", 1), "unknown-node-set", /no node set of that name/);
    assertRefused(() => capsule.silhouette(1, 0, 2), "value", /points is 2, it must be in \[3, 100000\]/);
    assertRefused(() => model.predict(0.15, 1.1, { extrapolate: true }).volume(20), "beyond-wall", /no capsule has/);
    // What was refused leaves the other predictions as they were.
    assert.ok(capsule.volume(1) > 0);
  });

  test("of a file", async () => {
    await assertRefused(load(readFileSync(archives[0])), "magic", /not a model file: it starts with/);
    await assertRefused(load(readFileSync(MODEL).subarray(0, 5000)), "truncated", /5000 found/);
    await assertRefused(load("missing.crom"), "not-read", /missing.crom could not be read: ENOENT/);
    await assertRefused(load(new URL("http://127.0.0.1:9/a.crom")), "not-read", /127.0.0.1:9.a.crom could not be read/);
  });

  test("of an outline", async () => {
    const refused = (outline, change, code, words) =>
      assertRefused(identify(model, outline, { ...SETUP, observable: "midplane", ...change }), code, words);
    await refused(TEXT, { viscosity_pa_s: undefined }, "setup", /^missing field `viscosity_pa_s`$/);
    await refused(TEXT, { velocity: 5 }, "setup", /unknown field `velocity`/);
    await refused(TEXT, { flow_rate_ul_min: 1 }, "setup-velocities", /give one of velocity_mm_s/);
    await refused(TEXT, { unit: "px" }, "text-units", /headings say um/);
    await refused([[1, 2]], {}, "contour-short", /at least 12/);
    await refused(Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10), {}, "picture-unreadable", /./);
    await refused(TEXT, { half_width_um: 12 }, "contour-wide", /wide/);
  });

  test("of what was disposed", async () => {
    const other = await load(MODEL);
    const capsule = other.predict(0.1, 0.9);
    await identify(other, TEXT, { ...SETUP, observable: "midplane" });
    other.dispose();
    other.dispose();
    for (const ask of [() => other.predict(0.1, 0.9), () => capsule.volume(1), () => other.describe()]) {
      assertRefused(ask, "disposed", /the model was disposed: load it again/);
    }
    await assertRefused(identify(other, TEXT, { ...SETUP, observable: "midplane" }), "disposed", /load it again/);
    assert.ok(model.predict(0.1, 0.9).volume(1) > 0, "other models live on");
  });
});

test("predictions in turns answer as one after another", () => {
  const [one, other] = [model.predict(0.1, 0.9), model.predict(0.05, 0.8, { method: "paper" })];
  const alone = [one, other].map((capsule) => capsule.observables(3));
  for (let turn = 0; turn < 3; turn++) {
    assert.deepEqual(one.observables(3), alone[0]);
    assert.deepEqual(other.observables(3), alone[1]);
  }
  assert.notDeepEqual(alone[0], alone[1]);
});

test("memory does not grow: of predictions, of models that are disposed, of models that are forgotten", () => {
  const script = written(
    "memory.js",
    `import { load } from "capsule-rom";
     import initialise from "${new URL(`file://${folder}/node_modules/capsule-rom/dist/capsule_wasm.js`).href}";
     const model = await load();
     const { memory } = await initialise();
     const grown = async (count, task) => {
       for (let i = 0; i < 5; i++) await task();
       const before = memory.buffer.byteLength;
       for (let i = 0; i < count; i++) await task();
       return memory.buffer.byteLength - before;
     };
     const bytes = model.file();
     const forget = async () => {
       (await load(bytes)).predict(0.1, 0.9).volume(1);
       gc();
       await new Promise((wake) => setTimeout(wake));
     };
     console.log(JSON.stringify([
       await grown(5000, () => model.predict(0.1, 0.9)),
       await grown(10, async () => (await load(bytes)).dispose()),
       await grown(10, forget),
     ]));`,
  );
  const [predictions, disposed, forgotten] = JSON.parse(
    execFileSync(process.execPath, ["--expose-gc", script], { cwd: folder, encoding: "utf8" }),
  );
  assert.equal(predictions, 0);
  assert.equal(disposed, 0);
  // Ten models would take more than ten times the file.
  assert.ok(forgotten < 5 * readFileSync(MODEL).length, `${forgotten} bytes`);
});

test("the documents' examples run", () => {
  written("outline.csv", TEXT);
  const scripts = ["README.md", "wasm/npm/capsule-rom/README.md", "docs/guides/javascript.md"].flatMap((document) =>
    examples(document, "js"),
  );
  assert.equal(scripts.length, 7);
  const names = scripts.map((script, i) => {
    written(`example-${i}.js`, script);
    return `./example-${i}.js`;
  });
  const all = names.map((name) => `console.log("${name}"); await import("${name}");`).join("\n");
  const output = run(folder, process.execPath, written("examples.js", all));
  // Each says something, and nothing in vain.
  for (const said of output.split(/^\.\/example.*$/m).slice(1)) assert.notEqual(said.trim(), "");
  assert.ok(!/undefined|NaN/.test(output), output);
  assert.match(output, /^identified 0\.0[67]/m);
  assert.match(output, /^outside-domain|^beyond-steady-limit/m);
});

test("the types are what the modules are", () => {
  const example = written(
    "example.ts",
    `import { CapsuleError, load, type Fields, type Model, type Prediction } from "capsule-rom";
     import { identify, type Answer } from "capsule-rom/identify";

     using model: Model = await load(new Uint8Array(3));
     const capsule: Prediction = model.predict(0.1, 0.9, { extrapolate: true, method: "paper" });
     const other: Prediction = model.predict([1, 2, 3]);
     const bound: number | undefined = capsule.bound(3);
     const fields: Fields = capsule.fields(3);
     const outline: Float32Array = other.outline("midplane", 3);
     const { answer } = await identify(model, [[0, 1]], {
       half_width_um: 25, flow_rate_ul_min: 5, viscosity_pa_s: 0.8, observable: "midplane",
     });
     const modulus: number = (answer satisfies Answer).gs_n_per_m;
     const low: number | null = answer.gs_n_per_m_95[0];
     const code: string = new CapsuleError("a", "b").code;
     export { bound, code, fields, low, modulus, outline };

     // @ts-expect-error: the plane has no such name
     capsule.outline("equator", 3);
     // @ts-expect-error: a bound may be missing
     capsule.bound(3).toFixed(3);
     // @ts-expect-error: the confinement is missing
     model.predict(0.1);
     // @ts-expect-error: the viscosity is missing
     identify(model, "", { half_width_um: 25, velocity_mm_s: 5, observable: "midplane" });
     // @ts-expect-error: a model is loaded, not made
     new Model();
     `,
  );
  run(folder, process.execPath, TSC, "--strict", "--noEmit", "--target", "es2022", "--module", "nodenext", example);
});
