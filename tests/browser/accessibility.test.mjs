// axe-core finds no violation: wide and narrow, light and dark, with and without an answer.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { drop, identified, picture, SETUP, section } from "./outlines.mjs";
import { explorer, FLAT, settled } from "./support.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const DESKTOP = { width: 1440, height: 900 };
const PHONE = { width: 390, height: 844 };
const EVERYTHING =
  "#ca=0.08&al=0.9&t=3&pins=A:direct:0.1,0.9;B:paper:0.05,0.8&layer=error_bound" +
  "&views=midplane.diagonal.transversal.plots";
const SITUATIONS = {
  desktop: ["#initial=0", DESKTOP],
  phone: ["#initial=0", PHONE],
  "refused parameters": [`#ca=0.9&al=0.9${FLAT}`, DESKTOP],
  extrapolated: [`#ca=0.13&al=0.95&t=3&extrapolate=1${FLAT}`, DESKTOP],
  "refused shape": [`#ca=0.15&al=1.1&t=20&extrapolate=1${FLAT}`, DESKTOP],
  "compared, plotted and mapped": [`${EVERYTHING}&dims=100,1,10`, DESKTOP],
  "compared, plotted and mapped, phone": [EVERYTHING, PHONE],
  "coloured in space": ["#views=solid&initial=0&colour=tension_1&clip=y", { width: 720, height: 560 }],
  "coloured in space, phone": ["#views=solid&initial=0&colour=load", PHONE],
  "a link of another model": [`#m=01234567&file=own.crom&ca=0.1&al=0.9${FLAT}`, DESKTOP],
  "no outline yet": ["#views=midplane.measured", DESKTOP],
  "missing model": ["?model=./nothing.crom", DESKTOP],
};

const { open } = explorer();

/** No violation of all rules in light colours, none of the contrast in dark ones. */
async function assertAccessible(page) {
  await page.evaluate(AXE);
  for (const [colorScheme, rules] of [
    ["light", {}],
    ["dark", { runOnly: ["color-contrast"] }],
  ]) {
    await page.emulateMedia({ colorScheme });
    await settled(page);
    const { violations } = await page.evaluate((options) => window.axe.run(document, options), rules);
    const found = violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(" | ")}`);
    assert.deepEqual(found, [], colorScheme);
  }
}

for (const [situation, [address, viewport]] of Object.entries(SITUATIONS)) {
  test(`accessibility: ${situation}`, async () => {
    const { page, close } = await open(address, { viewport });
    await assertAccessible(page);
    await close();
  });
}

for (const [situation, viewport] of [
  ["desktop", DESKTOP],
  ["phone", PHONE],
]) {
  test(`accessibility: an identified outline, ${situation}`, async () => {
    const { page, close } = await open(`#ca=0.1&al=0.9&t=2&layer=misfit${SETUP}${FLAT}`, { viewport });
    await drop(page, "capsule.png", picture(await section(0.06, 0.95)));
    await identified(page);
    await page.waitForSelector("#map .region-of", { state: "attached" });
    await assertAccessible(page);
    const [content, window_] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
    assert.ok(content <= window_, `${content} px of content in ${window_} px`);
    await close();
  });
}

for (const dialog of ["take-away", "units", "help"]) {
  test(`accessibility: the dialog ${dialog}`, async () => {
    const { page, close } = await open("#views=midplane");
    await page.click(`#open-${dialog}`);
    await page.waitForSelector(`#${dialog}[open]`);
    await assertAccessible(page);
    await close();
  });
}

test("nothing is wider than a phone", async () => {
  const { page, close } = await open("#initial=0", { viewport: { width: 360, height: 740 } });
  const [content, window_] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
  assert.ok(content <= window_, `${content} px of content in ${window_} px`);
  await close();
});

test("every control is reached by the Tab key and shows that it has the focus", async () => {
  const { page, close } = await open("#initial=0");
  const reached = new Set();
  for (let i = 0; i < 60; i++) {
    await page.keyboard.press("Tab");
    const found = await page.evaluate(() => {
      const { activeElement } = document;
      if (activeElement === null || activeElement === document.body) return null;
      const id = activeElement.id || activeElement.dataset.toggles || activeElement.name || activeElement.tagName;
      return { id, visible: activeElement.matches(":focus-visible") };
    });
    if (found === null) break;
    assert.ok(found.visible, `${found.id} shows its focus`);
    reached.add(found.id);
  }
  const controls = [
    "copy-link",
    "map-point",
    "ca",
    "confinement",
    "method",
    "frame",
    "play",
    "time",
    "speed",
    "section",
  ];
  for (const id of controls) {
    assert.ok(reached.has(id), `${id} is reached; reached: ${[...reached].join(", ")}`);
  }
  await close();
});
