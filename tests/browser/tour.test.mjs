// The tour: by keyboard, beside the parts that it is about, never unasked.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { explorer, FLAT, settled } from "./support.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const { onPage } = explorer();

const WORDS = [/Ca.*a\/ℓ/s, /Direct.*Paper/s, /plane/, /bound/, /instant/, /simulations.*Entropy.*capsule-rom/s];

onPage("the tour has six steps, by keyboard alone, and is remembered", `#t=3${FLAT}`, async (page) => {
  assert.equal(await page.isVisible("#tour"), false, "it does not open unasked");
  await page.focus("#open-tour");
  await page.keyboard.press("Enter");
  for (const [i, words] of WORDS.entries()) {
    assert.equal(await page.innerText("#tour-count"), `${i + 1} of 6`);
    assert.match(await page.innerText("#tour-words"), words);
    assert.equal(await page.evaluate(() => document.activeElement.id), "tour-title", "the words are read");
    assert.equal(await page.locator("[data-toured]").count(), 1);
    // Count, Back (not at the first step), Next.
    for (let press = 0; press < (i === 0 ? 1 : 2); press++) await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "tour-next");
    await page.keyboard.press("Enter");
  }
  await settled(page);
  assert.equal(await page.isVisible("#tour"), false);
  assert.equal(await page.locator("[data-toured]").count(), 0);
  assert.equal(await page.isVisible("#open-tour"), false);
  await page.reload();
  await page.waitForFunction(() => document.body.dataset.status === "ready");
  assert.equal(await page.isVisible("#open-tour"), false, "seen is seen");
  await page.keyboard.press("?");
  await page.click("#tour-from-help");
  assert.equal(await page.isVisible("#help"), false);
  assert.equal(await page.innerText("#tour-count"), "1 of 6");
  await page.keyboard.press("Escape");
  assert.equal(await page.isVisible("#tour"), false);
});

for (const [name, viewport] of [
  ["a desktop", { width: 1366, height: 768 }],
  ["a phone", { width: 394, height: 852 }],
]) {
  onPage(
    `the tour stays within ${name} and lets the page be used`,
    `#t=3${FLAT}`,
    async (page) => {
      await page.click("#open-tour");
      await page.evaluate(AXE);
      for (const i of WORDS.keys()) {
        await settled(page);
        const box = await page.locator("#tour").boundingBox();
        assert.ok(box.x >= 0 && box.x + box.width <= viewport.width, `step ${i}: ${JSON.stringify(box)}`);
        assert.ok(box.y >= 0 && box.y + box.height <= viewport.height, `step ${i}: ${JSON.stringify(box)}`);
        // The page around it has checks of its own.
        const { violations } = await page.evaluate(() => window.axe.run("#tour"));
        assert.deepEqual(
          violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(" | ")}`),
          [],
        );
        if (i === 0) {
          await page.fill("#ca", "0.06");
          assert.equal(await page.evaluate(() => window.capsuleExplorer.state.ca), 0.06);
        }
        await page.click("#tour-next");
      }
    },
    { viewport },
  );
}
