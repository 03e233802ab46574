// Random use of the page: no error, an answer that is the core's, and no more memory than at first.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { useAtRandom } from "./random-use.mjs";
import { FLAT, predict, QUANTITIES, serve, startBrowser } from "./support.mjs";

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

test("300 random steps leave no error, an answer that is the core's, and the memory as it was", async () => {
  const { page, errors, memory, close } = await useAtRandom(browser, `${server.url}#t=3${FLAT}`, 300);
  assert.deepEqual(errors, []);
  const megabytes = memory.map((bytes) => bytes / 2 ** 20);
  assert.ok(megabytes[0] > 1 && megabytes.at(-1) <= 1.1 * megabytes[4], `MB after each tenth: ${megabytes}`);
  const last = await page.evaluate(() => {
    const query = { ca: 0.06, confinement: 0.85, t: 5, method: "direct", extrapolate: false };
    window.capsuleExplorer.set({ ...query, playing: false });
    return window.capsuleExplorer.read();
  });
  const [expected] = predict(0.06, 0.85, [5], "direct").instants;
  for (const quantity of QUANTITIES) {
    assert.equal(Math.fround(last[quantity]), Math.fround(expected[quantity]), quantity);
  }
  await close();
});
