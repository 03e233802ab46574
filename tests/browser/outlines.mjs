// Outlines of capsules for the tests: as a text of points in um, and as a picture.

import assert from "node:assert/strict";
import { crc32, deflateSync } from "node:zlib";
import { capsuleRom, MODEL, openModel } from "./support.mjs";

/** Information on the outlines below: the fragment of a link, and the options of the command. */
export const HALF_WIDTH_UM = 25;
export const SETUP = `&half=${HALF_WIDTH_UM}&vel=5&visc=0.8`;
const OPTIONS = ["--half-width-um", HALF_WIDTH_UM, "--velocity-mm-s", 5, "--viscosity-pa-s", 0.8];

/** The answer of `capsule-rom identify` for a file. */
export function identify(file, options = ["-o", "midplane"]) {
  return JSON.parse(capsuleRom(["identify", file, ...OPTIONS, ...options, "--model", MODEL, "--json"]));
}

/** All numbers of an answer by their keys. */
function numbers(answer, path = "") {
  return Object.entries(answer).flatMap(([key, value]) => {
    if (typeof value === "number" || value === null) return [[path + key, value]];
    return typeof value === "object" ? numbers(value, `${path + key}.`) : [];
  });
}

/** Both answers have the same keys and the same numbers, but for the last bits that functions of two systems give. */
export function assertSame(found, expected) {
  assert.equal(found.verdict, expected.verdict);
  const [own, other] = [numbers(found), numbers(expected)];
  assert.deepEqual(
    own.map(([key]) => key),
    other.map(([key]) => key),
  );
  assert.ok(own.length > 30, `${own.length} numbers`);
  own.forEach(([key, value], i) => {
    const wanted = other[i][1];
    const isSame =
      wanted === null ? value === null : Math.abs(value - wanted) <= 1e-7 * Math.max(Math.abs(wanted), 1e-3);
    assert.ok(isSame, `${key}: ${value}, by the command ${wanted}`);
  });
}

/** The section z = 0 of a steady capsule, points around it in l, the front at x = 0. */
export async function section(ca, confinement) {
  const model = await openModel();
  const evaluation = model.evaluation();
  evaluation.prepare(Float64Array.of(ca, confinement), "direct", false);
  evaluation.goTo(model.endTime);
  const flat = evaluation.outline("midplane");
  const half = Array.from({ length: flat.length / 2 }, (_, i) => [flat[2 * i] - flat[0], flat[2 * i + 1]]);
  const mirrored = half.slice(1, -1).map(([x, r]) => [x, -r]);
  return [...half, ...mirrored.reverse()];
}

/** The points in um as a text, each a little off, by numbers that are the same each time. */
export function pointsText(points, headings = "x_um,y_um") {
  let state = 1;
  const off = () => {
    state = (state * 16807) % 2147483647;
    return 0.2 * (state / 2147483647 - 0.5);
  };
  const rows = points.map(([x, r]) => [HALF_WIDTH_UM * x + 90, HALF_WIDTH_UM * r + 40].map((at) => at + off()));
  return `${headings}\n${rows.map((row) => row.map((at) => at.toFixed(4)).join(",")).join("\n")}\n`;
}

/** A picture of the channel with dark walls and the capsule in it, `scale` pixels for l, as PNG. */
export function picture(points, scale = 60, [width, height] = [300, 160]) {
  const inside = (x, y) => {
    let isInside = false;
    for (let i = 0; i < points.length; i++) {
      const [[a, b], [c, d]] = [points[i], points[(i + 1) % points.length]];
      if (b <= y !== d <= y && x < a + ((y - b) / (d - b)) * (c - a)) isInside = !isInside;
    }
    return isInside;
  };
  const at = (x, y) => {
    if (Math.abs(y) > 1) return Math.abs(y) < 1.06 ? 60 : 170;
    return inside(x, y) ? 110 : 200;
  };
  const rows = Buffer.alloc(height * (width + 1));
  for (let row = 0; row < height; row++) {
    for (let column = 0; column < width; column++) {
      let sum = 0;
      // Where a pixel is cut it has the mean of its parts.
      for (let part = 0; part < 25; part++) {
        const x = (column + ((part % 5) + 0.5) / 5 - (205 * width) / 300) / scale;
        const y = (row + (Math.floor(part / 5) + 0.5) / 5 - height / 2) / scale;
        sum += at(x, y);
      }
      rows[row * (width + 1) + 1 + column] = Math.round(sum / 25);
    }
  }
  return png(width, height, rows);
}

/** A grey PNG of 8 bits from its rows, each after a byte for the filter. */
function png(width, height, rows) {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type, "latin1"), data]);
    const [length, check] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(data.length);
    check.writeUInt32BE(crc32(body));
    return Buffer.concat([length, body, check]);
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head[8] = 8;
  const mark = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([mark, chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}

/** Drops a file on the page. */
export async function drop(page, name, content) {
  const base64 = Buffer.from(content).toString("base64");
  await page.evaluate(
    ([file, text]) => {
      const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([bytes], file));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    },
    [name, base64],
  );
}

/** Waits for an answer. */
export const identified = (page) => page.waitForSelector("output[data-identified]");
