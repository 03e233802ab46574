// How long the core takes in the browser: `npm run speed`, after `cargo xtask explore --build-only`.
// Everything is fulfilled from files, so that no server takes part.

import { resolve } from "node:path";
import { MODEL, startBrowser, WASM } from "./support.mjs";

const FILES = {
  "/capsule_wasm.js": resolve(WASM, "capsule_wasm.js"),
  "/capsule_wasm_bg.wasm": resolve(WASM, "capsule_wasm_bg.wasm"),
  "/capsule.crom": MODEL,
};

/** Runs in the page: medians, in microseconds. */
async function measure() {
  const { default: initialise, Model } = await import("/capsule_wasm.js");
  await initialise({ module_or_path: "/capsule_wasm_bg.wasm" });
  const bytes = new Uint8Array(await (await fetch("/capsule.crom")).arrayBuffer());
  const medians = {};
  const time = (name, repetitions, task) => {
    // The engine compiles hot code in the background.
    const warm = performance.now() + 500;
    for (let i = 0; performance.now() < warm; i++) task(-1 - i);
    const samples = Array.from({ length: 15 }, (_, sample) => {
      const start = performance.now();
      for (let i = 0; i < repetitions; i++) task(sample * repetitions + i);
      return (1e3 * (performance.now() - start)) / repetitions;
    });
    medians[name] = samples.sort((a, b) => a - b)[7];
  };

  time("open the model", 1, () => Model.open(bytes).free());
  const model = Model.open(bytes);
  const evaluation = model.evaluation();
  for (const method of ["direct", "paper"]) {
    // Each query is new: the core keeps the results of the last one.
    const query = (i) => evaluation.prepare(Float64Array.of(0.05 + 1e-6 * (i % 40_000), 0.9), method, false);
    const readings = (t) => {
      evaluation.goTo(t);
      evaluation.readings().free();
    };
    time(`${method}: new query, read-outs at t = 6`, 20, (i) => {
      query(i);
      readings(6);
    });
    time(`${method}: new query, surface at t = 6`, 20, (i) => {
      query(i + 1000);
      evaluation.goTo(6);
      evaluation.surface();
    });
    time(`${method}: new query, 101 surfaces`, 2, (i) => {
      query(i + 2000);
      for (let k = 0; k <= 100; k++) {
        evaluation.goTo((model.endTime * k) / 100);
        evaluation.surface();
      }
    });
  }
  return medians;
}

const browser = await startBrowser();
try {
  const page = await browser.newPage();
  await page.route("http://explorer.test/**", (route) => {
    const path = FILES[new URL(route.request().url()).pathname];
    return path === undefined ? route.fulfill({ contentType: "text/html", body: "" }) : route.fulfill({ path });
  });
  await page.goto("http://explorer.test/");
  for (const [task, median] of Object.entries(await page.evaluate(measure))) {
    process.stdout.write(`${task.padEnd(40)} ${median.toFixed(1).padStart(9)} us\n`);
  }
} finally {
  await browser.close();
}
