// The page on screens of laptops and larger: all figures are seen whole, at once, in both languages.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { explorer, settled } from "./support.mjs";

const { open } = explorer();
const SCREENS = [
  [1366, 768],
  [1366, 650],
  [1024, 768],
  [1920, 1080],
];
/** Less than this is no drawing to read, in pixels. */
const LEAST = 110;

/** Boxes of all open figures, of what stands above and below them, and of their drawings. */
function boxes(page) {
  return page.evaluate(() => {
    const box = (part) => {
      const { left, top, right, bottom } = part.getBoundingClientRect();
      return { left, top, right, bottom };
    };
    const figures = [...document.querySelectorAll("figure.view:not([hidden])")];
    return {
      above: document.querySelector(".masthead").getBoundingClientRect().bottom,
      below: document.querySelector(".transport").getBoundingClientRect().top,
      wide: document.documentElement.scrollWidth,
      figures: figures.map((figure) => ({ name: figure.dataset.view, ...box(figure) })),
      stages: figures.map((figure) => ({ name: figure.dataset.view, ...box(figure.querySelector(".stage")) })),
    };
  });
}

function assertWhole({ above, below, wide, figures, stages }, width, names) {
  assert.ok(wide <= width, `${wide} px wide`);
  for (const name of names) {
    const figure = figures.find((one) => one.name === name);
    const isWhole = figure.top >= above && figure.bottom <= below + 0.5 && figure.left >= 0 && figure.right <= width;
    assert.ok(isWhole, `${name} between ${above} and ${below}: ${JSON.stringify(figure)}`);
    const stage = stages.find((one) => one.name === name);
    assert.ok(stage.bottom - stage.top >= LEAST, `${name} is ${stage.bottom - stage.top} px high`);
    assert.ok(stage.bottom <= figure.bottom + 0.5, `${name}: its drawing stays within it`);
    // No figure lies over another one.
    for (const other of figures) {
      const isApart =
        other === figure ||
        other.left >= figure.right ||
        other.right <= figure.left ||
        other.top >= figure.bottom ||
        other.bottom <= figure.top;
      assert.ok(isApart, `${name} lies over ${other.name}`);
    }
  }
}

describe("the figures are seen whole", () => {
  const FOUR = ["solid", "midplane", "diagonal", "transversal"];
  for (const [situation, address] of [
    ["in English", "#ca=0.1&al=0.9&t=3&initial=0"],
    ["in French, with a notice", "?lang=fr#ca=0.13&al=0.95&t=3&extrapolate=1&initial=0"],
    ["with plots below them", "#ca=0.1&al=0.9&initial=0&views=solid.midplane.diagonal.transversal.plots"],
  ]) {
    test(situation, async () => {
      const { page, close } = await open(address);
      for (const [width, height] of SCREENS) {
        await page.setViewportSize({ width, height });
        await settled(page);
        await page.$eval("#workbench", (part) => part.scrollTo(0, 0));
        assertWhole(await boxes(page), width, FOUR);
        if (address.includes("plots")) continue;
        // Whatever is scrolled into sight beside them.
        await page.locator("#errors").scrollIntoViewIfNeeded();
        const scrolled = await boxes(page);
        assertWhole(scrolled, width, FOUR);
        const errors = await page.locator("#errors").boundingBox();
        assert.ok(errors.y + errors.height <= scrolled.below, "the last line beside them can be read");
      }
      await close();
    });
  }
});
