// The page without a network: kept after the first visit, replaced by a new version, and opened as a file.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { serveFolder } from "./static-server.mjs";
import { DIST, EXPLORER, openPage, otherModel, startBrowser } from "./support.mjs";

let browser;
let folder;

before(async () => {
  browser = await startBrowser();
  folder = mkdtempSync(join(tmpdir(), "capsule-"));
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

/** Serves a folder for one test; `stop` cuts the network. */
async function serve(context, files) {
  const server = await serveFolder(files);
  context.after(server.stop);
  return server;
}

const open = (url) => openPage(browser, url, { isKept: true });
const kept = (page) => page.evaluate(async () => (await navigator.serviceWorker.ready).active.state);
const digest = (page) => page.getAttribute("#model", "data-digest");
const ready = (page) => page.waitForFunction(() => document.body.dataset.status === "ready");

test("the page works without a network after the first visit", async (context) => {
  const server = await serve(context, DIST);
  const { page, errors, close } = await open(`${server.url}#ca=0.05&al=0.9&t=3&views=midplane`);
  await kept(page);
  const model = await digest(page);
  server.stop();
  for (const address of [`${server.url}#ca=0.06&al=0.9&t=4&views=solid`, `${server.url}index.html?controls=none`]) {
    await page.goto("about:blank");
    await page.goto(address);
    await ready(page);
    assert.equal(await digest(page), model);
  }
  await page.goto("about:blank");
  await page.goto(`${server.url}#views=solid&colour=load&t=4`);
  // Files that are loaded when they are first needed are kept as well.
  await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
  assert.deepEqual(errors, []);
  await page.goto(`${server.url}THIRD-PARTY.txt`);
  assert.match(await page.innerText("body"), /Licenses|three/i);
  await close();
});

test("a new version is offered, and takes the place of the one before", async (context) => {
  const first = join(folder, "page");
  cpSync(DIST, first, { recursive: true });
  const server = await serve(context, first);
  const { page, errors, close } = await open(`${server.url}#ca=0.05&al=0.9&t=3&views=midplane`);
  await kept(page);
  const model = await digest(page);
  // The same page with another model: what `cargo xtask explore` makes where CAPSULE_MODEL names one.
  const CAPSULE_MODEL = otherModel();
  const vite = resolve(EXPLORER, "node_modules/vite/bin/vite.js");
  execFileSync(process.execPath, [vite, "build", "--outDir", first, "--emptyOutDir", "--logLevel", "error"], {
    cwd: EXPLORER,
    env: { ...process.env, CAPSULE_MODEL },
  });
  await page.reload();
  await ready(page);
  assert.equal(await digest(page), model, "what is kept is shown at once");
  await page.waitForSelector("#new-version:not([hidden])");
  await page.click("#new-version");
  await page.waitForFunction(() => document.body.dataset.model === "other");
  assert.notEqual(await digest(page), model);
  assert.equal(await page.isVisible("#new-version"), false);
  server.stop();
  await page.reload();
  await ready(page);
  assert.equal(await page.getAttribute("body", "data-model"), "other");
  assert.deepEqual(errors, []);
  await close();
});

test("a page in a frame is not kept", async (context) => {
  const site = join(folder, "site");
  cpSync(DIST, site, { recursive: true });
  writeFileSync(join(site, "frame.html"), '<iframe src="./?controls=none#views=midplane"></iframe>');
  const server = await serve(context, site);
  const page = await browser.newPage();
  await page.goto(`${server.url}frame.html`);
  await page.frames()[1].waitForFunction(() => document.body?.dataset.status === "ready");
  assert.equal(await page.evaluate(async () => (await navigator.serviceWorker.getRegistrations()).length), 0);
  await page.goto(server.url);
  await kept(page);
  assert.equal(await page.evaluate(async () => (await navigator.serviceWorker.getRegistrations()).length), 1);
  await page.close();
});

test("opened as a file the page says how to serve it", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(pathToFileURL(join(DIST, "index.html")).href);
  const words = await page.innerText("body");
  assert.match(words, /has to be served[\s\S]*python3 -m http\.server[\s\S]*cargo xtask explore/);
  await context.close();
});

test("the icons that the manifest names are there, in the sizes that it says", () => {
  const dist = resolve(EXPLORER, "dist");
  const { icons } = JSON.parse(readFileSync(resolve(dist, "manifest.webmanifest"), "utf8"));
  const pictures = icons.filter(({ type }) => type === "image/png");
  for (const { src, sizes } of pictures) {
    const file = readFileSync(resolve(dist, src));
    assert.equal(file.toString("latin1", 1, 4), "PNG");
    assert.equal(`${file.readUInt32BE(16)}x${file.readUInt32BE(20)}`, sizes);
  }
  const found = pictures.map(({ sizes, purpose }) => `${sizes} ${purpose}`);
  assert.deepEqual(found, ["192x192 any", "512x512 any", "512x512 maskable"]);
});
