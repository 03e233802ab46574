// How long the core takes in the browser: `npm run speed`, after `cargo xtask explore --build-only`.
// Everything is fulfilled from files, so that no server takes part.

import { resolve } from "node:path";
import { picture, pointsText, section } from "./outlines.mjs";
import { MODEL, startBrowser, WASM } from "./support.mjs";

const FILES = {
  "/capsule_wasm.js": resolve(WASM, "capsule_wasm.js"),
  "/capsule_wasm_bg.wasm": resolve(WASM, "capsule_wasm_bg.wasm"),
  "/capsule_identify_wasm.js": resolve(WASM, "capsule_identify_wasm.js"),
  "/capsule_identify_wasm_bg.wasm": resolve(WASM, "capsule_identify_wasm_bg.wasm"),
  "/capsule.crom": MODEL,
};

/** Runs in the page: medians, in microseconds. `outlines` are files by name, their bytes in base 64. */
async function measure(outlines) {
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

  const { default: load, Identifier } = await import("/capsule_identify_wasm.js");
  await load({ module_or_path: "/capsule_identify_wasm_bg.wasm" });
  const identifier = Identifier.open(bytes);
  const said = { half_width_um: 25, velocity_mm_s: 5, viscosity_pa_s: 0.8, flow: "right", capsule: null };
  const identify = (name, observable, more = {}) => {
    const file = Uint8Array.from(atob(outlines[name]), (letter) => letter.charCodeAt(0));
    const words = JSON.stringify({ ...said, observable, unit: null, pixel_um: null, ...more });
    time(`identify: ${name}, ${observable}`, 1, () => identifier.identify(name, file, words));
  };
  for (const name of ["picture.png", "64.csv", "600.csv"]) identify(name, "midplane");
  identify("600.csv", "silhouette");
  identify("600.csv", "midplane");
  // The map of the page: 56 places in each of 36 rows.
  const [caLeast, caMost, least, most] = model.ranges();
  const places = Float64Array.from({ length: 2 * 56 * 36 }, (_, i) => {
    const [column, row] = [Math.floor(i / 2) % 56, Math.floor(i / 112)];
    return i % 2 === 0 ? caLeast + ((caMost - caLeast) * column) / 55 : least + ((most - least) * row) / 35;
  });
  time("identify: misfit over the domain", 1, () => identifier.misfit(places));
  return medians;
}

/** The outline of a capsule by so many points. */
async function outline(count) {
  const points = await section(0.06, 0.95);
  const at = (share) => {
    const [i, part] = [Math.floor(share), share % 1];
    const [[a, b], [c, d]] = [points[i % points.length], points[(i + 1) % points.length]];
    return [a + part * (c - a), b + part * (d - b)];
  };
  return pointsText(Array.from({ length: count }, (_, i) => at((i * points.length) / count)));
}

const OUTLINES = {
  "picture.png": picture(await section(0.06, 0.95)).toString("base64"),
  "64.csv": btoa(await outline(64)),
  "600.csv": btoa(await outline(600)),
};

const browser = await startBrowser();
try {
  const page = await browser.newPage();
  await page.route("http://explorer.test/**", (route) => {
    const path = FILES[new URL(route.request().url()).pathname];
    return path === undefined ? route.fulfill({ contentType: "text/html", body: "" }) : route.fulfill({ path });
  });
  await page.goto("http://explorer.test/");
  for (const [task, median] of Object.entries(await page.evaluate(measure, OUTLINES))) {
    process.stdout.write(`${task.padEnd(40)} ${median.toFixed(1).padStart(9)} us\n`);
  }
} finally {
  await browser.close();
}
