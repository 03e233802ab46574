// Pictures of every view, compared with stored ones: `npm run snapshots`, after `cargo xtask explore --build-only`.
// With `--write` the pictures of this run become the stored ones. New pictures and differences: target/snapshots.

import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import pixelmatch from "pixelmatch";
import { drop, identified, pointsText, SETUP, section } from "./outlines.mjs";
import { openPage, ROOT, serve, settled, startBrowser } from "./support.mjs";

const STORED = resolve(import.meta.dirname, "snapshots");
const MADE = resolve(ROOT, "target/snapshots");
/** Share of the pixels that may differ; a pixel differs by more than this share of the way from black to white. */
const TOLERANCE = { pixels: 0.002, colour: 0.15 };

const QUERY = "#ca=0.08&al=0.9&t=3";
const OUTLINE = pointsText(await section(0.06, 0.95));
const FIGURES = "figure.view";
const isThere = (selector) => (page) => page.waitForSelector(selector, { state: "attached" });

/** Each view: its link, what it waits for, and what a narrow picture shows of the page. */
const VIEWS = {
  map: ["&layer=axial_length&views=midplane", isThere("#map .contour"), ".query"],
  sections: ["&views=midplane.diagonal.transversal", isThere("#track .trace:not([d=''])"), FIGURES],
  plots: ["&views=plots", isThere(".plot:last-child .curve.live[d^=M]"), FIGURES],
  space: ["&views=solid&colour=tension_1&clip=y", isThere("#solid[data-rendered=true]"), FIGURES],
  comparison: [
    "&views=midplane&pins=A:direct:0.1,0.9;B:paper:0.05,0.8",
    isThere("#compare:not([hidden]) .distance"),
    FIGURES,
  ],
  identification: [
    `&views=midplane.measured${SETUP}`,
    async (page) => {
      await drop(page, "outline.csv", OUTLINE);
      await identified(page);
      await isThere("#map .region-of")(page);
    },
    FIGURES,
  ],
};
const SIZES = { wide: { width: 1366, height: 768 }, narrow: { width: 394, height: 852 } };

/** Runs in the page: the strip across the window that holds all parts that are shown. */
function around(selector) {
  const parts = [...document.querySelectorAll(selector)].filter((part) => part.checkVisibility());
  const boxes = parts.map((part) => part.getBoundingClientRect());
  const [top, bottom] = [Math.min(...boxes.map((box) => box.top)), Math.max(...boxes.map((box) => box.bottom))];
  return { x: 0, y: top + window.scrollY, width: window.innerWidth, height: bottom - top };
}

/** Takes the pictures of a view at half the size: their names, and screenshots in PNG. */
async function* pictures(browser, url, view) {
  const [link, comeToRest, part] = VIEWS[view];
  const { page, errors, close } = await openPage(browser, `${url}${QUERY}${link}`, {
    viewport: SIZES.wide,
    deviceScaleFactor: 0.5,
    reducedMotion: "reduce",
  });
  await comeToRest(page);
  await page.evaluate(() => document.fonts.ready.then(() => true));
  for (const [size, viewport] of Object.entries(SIZES)) {
    for (const colorScheme of ["light", "dark"]) {
      await page.setViewportSize(viewport);
      await page.emulateMedia({ colorScheme });
      // Results of the gaps between frames are there as well.
      await page.waitForTimeout(500);
      await settled(page);
      const clip = size === "wide" ? undefined : await page.evaluate(around, part);
      const picture = await page.screenshot({ animations: "disabled", ...(clip && { clip, fullPage: true }) });
      yield [`${view}-${size}-${colorScheme}.webp`, picture];
    }
  }
  await close();
  if (errors.length > 0) throw new Error(`${view}: ${errors.join("\n")}`);
}

/** Runs in Chromium: a picture as WebP, a fifth of a PNG. */
async function encode([width, height, pixels]) {
  const canvas = new OffscreenCanvas(width, height);
  const data = new Uint8ClampedArray(Uint8Array.fromBase64(pixels).buffer);
  canvas.getContext("2d").putImageData(new ImageData(data, width, height), 0, 0);
  const blob = await canvas.convertToBlob({ type: "image/webp", quality: 0.6 });
  return new Uint8Array(await blob.arrayBuffer()).toBase64();
}

/** Runs in Chromium: the pixels of a picture. */
async function decode(picture) {
  const bitmap = await createImageBitmap(new Blob([Uint8Array.fromBase64(picture)]));
  const { width, height } = bitmap;
  const context = new OffscreenCanvas(width, height).getContext("2d");
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  return [width, height, new Uint8Array(data.buffer).toBase64()];
}

/** The fault of a picture, if any; a difference is drawn. */
async function judge(codec, name, made) {
  const stored = join(STORED, name);
  if (!existsSync(stored)) return "is not stored";
  const [wanted, found] = await Promise.all(
    [readFileSync(stored), made].map((picture) => codec.evaluate(decode, picture.toString("base64"))),
  );
  const [width, height] = found;
  if (wanted[0] !== width || wanted[1] !== height) {
    return `has ${width} x ${height} pixels, stored are ${wanted[0]} x ${wanted[1]}`;
  }
  const [before, after] = [wanted, found].map(([, , pixels]) => Buffer.from(pixels, "base64"));
  const drawn = Buffer.alloc(after.length);
  const count = pixelmatch(before, after, drawn, width, height, { threshold: TOLERANCE.colour });
  if (count <= TOLERANCE.pixels * width * height) return undefined;
  const difference = await codec.evaluate(encode, [width, height, drawn.toString("base64")]);
  writeFileSync(join(MADE, `difference-${name}`), difference, "base64");
  return `differs in ${count} of ${width * height} pixels`;
}

const isWritten = process.argv.includes("--write");
const server = await serve();
const browser = await startBrowser();
try {
  rmSync(MADE, { recursive: true, force: true });
  mkdirSync(MADE, { recursive: true });
  const codec = await browser.newPage();
  for (const view of Object.keys(VIEWS)) {
    for await (const [name, screenshot] of pictures(browser, server.url, view)) {
      const pixels = await codec.evaluate(decode, screenshot.toString("base64"));
      const made = Buffer.from(await codec.evaluate(encode, pixels), "base64");
      writeFileSync(join(MADE, name), made);
      const problem = isWritten ? undefined : await judge(codec, name, made);
      if (problem !== undefined) process.exitCode = 1;
      process.stdout.write(`${name.padEnd(36)} ${problem ?? (isWritten ? "taken" : "as stored")}\n`);
    }
  }
  if (isWritten) {
    rmSync(STORED, { recursive: true, force: true });
    cpSync(MADE, STORED, { recursive: true });
  }
  process.stdout.write(`Chromium ${browser.version()}; the pictures are in ${isWritten ? STORED : MADE}\n`);
} finally {
  await browser.close();
  server.stop();
}
