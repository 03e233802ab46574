// The conformance vectors in Node and in Chromium: the same bits as natively, in both precisions. The module is built
// by `cargo xtask test --only browser`, which passes its path in the environment variable CAPSULE_CONFORMANCE.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { startBrowser } from "./support.mjs";

const bytes = readFileSync(process.env.CAPSULE_CONFORMANCE);

/** Asks all vectors; runs in either engine. */
async function ask(base64) {
  const module = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
  const { instance } = await WebAssembly.instantiate(module);
  return [32, 64].map((bits) => ({ asked: instance.exports.asked(bits), different: instance.exports.different() }));
}

function good(results) {
  for (const { asked, different } of results) {
    assert.ok(asked > 300, `${asked} queries asked`);
    assert.equal(different, 0);
  }
}

test("Node gives the native bits", async () => {
  good(await ask(bytes.toString("base64")));
});

test("Chromium gives the native bits", async () => {
  const browser = await startBrowser();
  try {
    const page = await browser.newPage();
    good(await page.evaluate(ask, bytes.toString("base64")));
  } finally {
    await browser.close();
  }
});
