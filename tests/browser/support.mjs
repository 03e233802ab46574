// Shared by the tests: the server, the browser, a page that fails on console errors, and the native core.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { serveFolder } from "./static-server.mjs";

export const ROOT = resolve(import.meta.dirname, "../..");
export const EXPLORER = resolve(ROOT, "wasm/explorer");
/** The built page. */
export const DIST = resolve(EXPLORER, "dist");
/** Debian's Chromium, or another executable. */
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
const ARGUMENTS = [
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  // Debian's Chromium has the graphics card draw the page. An emulated one takes several times as long.
  "--disable-gpu-rasterization",
];

/** The shipped model, or the one that the page was built with. */
export const MODEL = resolve(ROOT, process.env.CAPSULE_MODEL ?? "models/capsule.crom");

/** The WebAssembly module, as `cargo xtask explore --build-only` builds it. */
export const WASM = resolve(EXPLORER, "src/wasm");

/** The model, opened by that module in Node. */
export async function openModel() {
  const { initSync, Model } = await import(resolve(WASM, "capsule_wasm.js"));
  initSync({ module: readFileSync(resolve(WASM, "capsule_wasm_bg.wasm")) });
  return Model.open(readFileSync(MODEL));
}

export { QUANTITIES } from "../../wasm/explorer/src/app/quantities.js";

/** Without the space view, which an emulated graphics card draws slowly. */
export const FLAT = "&views=midplane.diagonal.transversal";

/**
 * A server and a browser for the tests of one file. `open` opens the page at an address relative to the server's;
 * `onPage` defines a test that drives a fresh page, and fails if the console reports an error. The options of
 * `openPage` may be given for all.
 */
export function explorer(standard = {}) {
  let browser;
  let server;
  before(async () => {
    server = await serve();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    server?.stop();
  });
  const open = (address = "", options = {}) => openPage(browser, server.url + address, { ...standard, ...options });
  const onPage = (name, address, drive, options) =>
    test(name, async () => {
      const { page, errors, close } = await open(address, options);
      try {
        assert.equal(await page.getAttribute("body", "data-status"), "ready");
        await drive(page);
        assert.deepEqual(errors, [], "the console is silent");
      } finally {
        await close();
      }
    });
  return { open, onPage, url: () => server.url };
}

/** Starts Chromium. `extra` are further arguments. */
export function startBrowser(extra = []) {
  return chromium.launch({ executablePath: CHROMIUM, args: [...ARGUMENTS, ...extra] });
}

/** Serves wasm/explorer/dist, unless BASE_URL names a server. Returns its address and how to stop it. */
export function serve() {
  const { BASE_URL } = process.env;
  if (BASE_URL !== undefined) return { url: BASE_URL.replace(/\/?$/, "/"), stop: () => {} };
  return serveFolder(DIST);
}

/**
 * Opens the page and waits until it is ready or has failed; `errors` gathers the errors on the console. The options are
 * those of a context, `isKept`: whether the browser may keep the page for use without a network, and `before`: what
 * runs in it before its own program.
 */
export async function openPage(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
  // A page that is kept by the browser would ask neither the server nor the routes of a test.
  if (options.before) await context.addInitScript(options.before);
  if (!options.isKept) await context.addInitScript(() => delete Navigator.prototype.serviceWorker);
  const page = await context.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") errors.push(message.text());
  });
  await page.goto(address);
  await page.waitForFunction(() => document.body.dataset.status !== "loading");
  await settled(page);
  return { page, errors, close: () => context.close() };
}

/** Waits until the frame after the latest change has been drawn. */
export async function settled(page) {
  await page.evaluate(() => new Promise((wake) => requestAnimationFrame(() => requestAnimationFrame(wake))));
}

/** The read-outs on screen in full precision, by name; those without a value are left out. */
export function figures(page) {
  return page.$$eval("output[data-value]", (outputs) =>
    Object.fromEntries(outputs.map((output) => [output.dataset.quantity, Number(output.dataset.value)])),
  );
}

/** Runs the native `capsule-rom` and returns its output; throws with its message. CAPSULE_ROM names the program. */
export function capsuleRom(options) {
  const built = resolve(ROOT, process.env.CARGO_TARGET_DIR ?? "target", "debug/capsule-rom");
  const program = process.env.CAPSULE_ROM ?? built;
  if (!existsSync(program)) {
    throw new Error(`${program} is missing: \`cargo build --package capsule-rom\` builds it`);
  }
  return execFileSync(program, options.map(String), { encoding: "utf8", stdio: "pipe" });
}

/** The native core's answer: the JSON of `capsule-rom predict`. */
export function predict(ca, confinement, times, method, extrapolate = false) {
  const query = ["--ca", ca, "--confinement", confinement, "--t", times.join(","), "--method", method];
  if (extrapolate) query.push("--extrapolate");
  return JSON.parse(capsuleRom(["predict", ...query, "--model", MODEL, "--json"]));
}

/** The native core's fields at the nodes, a column of numbers by name: the CSV of `capsule-rom predict --fields`. */
export function predictFields(ca, confinement, t, method) {
  const folder = mkdtempSync(join(tmpdir(), "capsule-"));
  try {
    const file = join(folder, "fields.csv");
    const query = ["--ca", ca, "--confinement", confinement, "--t", t, "--method", method, "--model", MODEL];
    capsuleRom(["predict", ...query, "--fields", "all", "--csv", file]);
    const lines = readFileSync(file, "utf8").trim().split("\n");
    const [names, ...rows] = lines.filter((line) => !line.startsWith("#")).map((line) => line.split(","));
    return Object.fromEntries(names.map((name, i) => [name, Float32Array.from(rows, (row) => Number(row[i]))]));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Builds a model of "other people's data", series over ca and al, in a folder; returns its path. */
export function otherModel(folder) {
  const rows = ["series,ca,al"];
  for (const ca of [0.04, 0.06, 0.08]) {
    for (const al of [0.8, 0.85, 0.9]) {
      const query = ["--ca", ca, "--confinement", al, "--t", "0,0.5,1,1.5,2", "--model", MODEL];
      capsuleRom(["predict", ...query, "--vtu", resolve(folder, `${ca}-${al}`)]);
      rows.push(`${ca}-${al}/capsule.pvd,${ca},${al}`);
    }
  }
  writeFileSync(resolve(folder, "parameters.csv"), rows.join("\n"));
  const model = resolve(folder, "other.crom");
  capsuleRom(["offline", "build", "--from", folder, "--out", model, "--quiet"]);
  return model;
}
