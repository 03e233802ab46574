// Draws the icons of the installed page from its icon.svg: `node docs/pictures/icons.mjs`.

import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { startBrowser } from "../../tests/browser/support.mjs";

const FOLDER = resolve(import.meta.dirname, "../../wasm/explorer/public");
const GROUND = JSON.parse(readFileSync(resolve(FOLDER, "manifest.webmanifest"), "utf8")).background_color;
/** Of a maskable icon a system may cut off all beyond the middle four fifths: the drawing takes less. */
const ICONS = [
  { name: "icon-192", size: 192, share: 1, ground: "transparent" },
  { name: "icon-512", size: 512, share: 1, ground: "transparent" },
  { name: "icon-maskable", size: 512, share: 0.6, ground: GROUND },
];

const drawing = readFileSync(resolve(FOLDER, "icon.svg"), "utf8");
const browser = await startBrowser();
for (const { name, size, share, ground } of ICONS) {
  const page = await browser.newPage({ viewport: { width: size, height: size } });
  const style = `margin: 0; height: 100vh; display: grid; place-items: center; background: ${ground}`;
  await page.setContent(`<body style="${style}">${drawing}</body>`);
  await page.addStyleTag({ content: `svg { width: ${100 * share}vw; }` });
  await page.screenshot({ path: resolve(FOLDER, `${name}.png`), omitBackground: true });
  await page.close();
}
await browser.close();
