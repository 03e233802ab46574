// Shared by the tests: the server, the browser, a page that fails on console errors, and the native core.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, renameSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { crc32 } from "node:zlib";
import { chromium } from "playwright-core";
import { serveFolder } from "./static-server.mjs";

export const ROOT = resolve(import.meta.dirname, "../..");
export const EXPLORER = resolve(ROOT, "wasm/explorer");
const TARGET = resolve(ROOT, process.env.CARGO_TARGET_DIR ?? "target");
/** The built page. */
export const DIST = resolve(EXPLORER, "dist");
/** Debian's Chromium, or another executable. */
export const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
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

/** What a module of the page exports, in Node. */
export async function loaded(name) {
  const module = await import(resolve(WASM, `${name}.js`));
  module.initSync({ module: readFileSync(resolve(WASM, `${name}_bg.wasm`)) });
  return module;
}

/** A model, by default the shipped one, opened by that module in Node. */
export async function openModel(file = readFileSync(MODEL)) {
  const { Model } = await loaded("capsule_wasm");
  return Model.open(file);
}

export { QUANTITIES } from "../../wasm/explorer/src/app/quantities.js";

/** Without the space view, which an emulated graphics card draws slowly. */
export const FLAT = "&views=midplane.diagonal.transversal";

/**
 * A server and a browser for the tests of one file. `open` opens the page at an address relative to the server's;
 * `onPage` defines a test that drives a page, and fails if the console reports an error. The options of `openPage` may
 * be given for all. A page that was closed is opened again for the next test with the same options, which takes half
 * the time of a new one.
 */
export function explorer(standard = {}) {
  let browser;
  let server;
  const closed = new Map();
  before(async () => {
    server = await serve();
    browser = await startBrowser();
  });
  after(async () => {
    await browser?.close();
    server?.stop();
  });
  const open = async (address = "", more = {}) => {
    const options = { ...standard, ...more };
    if (options.before) return openPage(browser, server.url + address, options);
    const key = JSON.stringify(options);
    const made = closed.get(key)?.pop() ?? (await newPage(browser, options));
    await made.show(server.url + address);
    const close = async () => {
      await made.forget();
      closed.set(key, [...(closed.get(key) ?? []), made]);
    };
    return { ...made, close };
  };
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
export async function openPage(browser, address, options) {
  const { show, ...opened } = await newPage(browser, options);
  await show(address);
  return opened;
}

/** A page of these options, which `show` opens at an address, and which `forget` leaves as if it had just been made. */
async function newPage(browser, options = {}) {
  const { viewport = { width: 1440, height: 900 } } = options;
  const context = await browser.newContext({ ...options, viewport });
  // A page that is kept by the browser would ask neither the server nor the routes of a test.
  if (options.before) await context.addInitScript(options.before);
  if (!options.isKept) await context.addInitScript(() => delete Navigator.prototype.serviceWorker);
  const page = await context.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") errors.push(message.text());
  });
  const show = async (address) => {
    await page.goto(address);
    await page.waitForFunction(() => document.body.dataset.status !== "loading");
    await settled(page);
  };
  const forget = async () => {
    for (const other of context.pages()) if (other !== page) await other.close();
    await page.evaluate(() => window.localStorage.clear());
    await page.goto("about:blank");
    await page.mouse.move(0, 0);
    await page.setViewportSize(viewport);
    await page.emulateMedia({ colorScheme: options.colorScheme ?? "light" });
    errors.length = 0;
  };
  return { page, errors, show, forget, close: () => context.close() };
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
  return execFileSync(capsuleRomPath(), options.map(String), { encoding: "utf8", stdio: "pipe" });
}

function capsuleRomPath() {
  const program = process.env.CAPSULE_ROM ?? join(TARGET, "debug/capsule-rom");
  if (!existsSync(program)) {
    throw new Error(`${program} is missing: \`cargo build --package capsule-rom\` builds it`);
  }
  return program;
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

/** The model file with another law, of as many letters, and another bending stiffness of the membrane. */
export function membraneChanged(law, stiffness) {
  const HEADER = 16;
  const file = readFileSync(MODEL);
  const place = file.indexOf("neo-Hookean");
  file.write(law, place);
  const number = Buffer.alloc(8);
  number.writeDoubleLE(1e-4);
  file.writeDoubleLE(stiffness, file.indexOf(number, place));
  // In the header only the checksum of the payload changes.
  file.writeUInt32LE(crc32(file.subarray(HEADER)), HEADER - 4);
  return file;
}

/** A model of "other people's data", series over ca and al: built once for all files with tests; returns its path. */
export function otherModel() {
  const made = [capsuleRomPath(), MODEL].map((file) => Math.round(statSync(file).mtimeMs));
  const folder = join(TARGET, "browser-tests");
  const path = join(folder, `other-${made.join("-")}.crom`);
  if (existsSync(path)) return path;
  mkdirSync(folder, { recursive: true });
  const work = mkdtempSync(join(folder, "other-"));
  try {
    // Two files with tests may build it at a time.
    renameSync(buildOther(work), path);
  } finally {
    rmSync(work, { recursive: true });
  }
  return path;
}

/** Builds that model in a folder. */
function buildOther(folder) {
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
