// The identification of a membrane in the page: it gives the numbers of `capsule-rom identify`, draws them where they
// belong, names what is wrong with a file, and works beside the page.

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, describe, test } from "node:test";
import { assertSame, drop, identified, identify, picture, pointsText, SETUP, section } from "./outlines.mjs";
import { explorer, figures, otherModel, settled } from "./support.mjs";

const { open, onPage } = explorer();

const folder = mkdtempSync(join(tmpdir(), "capsule-outline-"));
after(() => rmSync(folder, { recursive: true }));

/** Writes a file and returns its path. */
function written(name, content) {
  const path = join(folder, name);
  writeFileSync(path, content);
  return path;
}

const TRUTH = { ca: 0.06, confinement: 0.95 };
const POINTS = await section(TRUTH.ca, TRUTH.confinement);
const TEXT = pointsText(POINTS);
const VIEW = "#ca=0.1&al=0.9&t=2&views=midplane";

/** The files that a button of the answer saves. */
async function saved(page, format) {
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: `Answer, ${format}`, exact: true }).click(),
  ]);
  return { name: download.suggestedFilename(), text: readFileSync(await download.path(), "utf8") };
}

describe("a contour", () => {
  onPage("that is dropped gives the command's answer", VIEW, async (page) => {
    await drop(page, "outline.csv", TEXT);
    const verdict = page.locator("#measured-verdict");
    await page.waitForFunction(() =>
      document.querySelector("#measured-verdict").textContent.includes("half the channel"),
    );
    // By the labels, as a person and a screen reader find the fields.
    await page.getByLabel("Half channel side ℓ, µm").fill("25");
    await page.getByLabel("Flow rate 4ℓ²V, µl/min").fill("0.75");
    await settled(page);
    assert.equal(await page.getByLabel("Mean velocity V, mm/s").inputValue(), "5");
    await page.getByLabel("Viscosity, Pa s").fill("0.8");
    await identified(page);
    const expected = identify(written("outline.csv", TEXT));
    assert.equal(await verdict.textContent(), `${expected.verdict}: ${expected.verdict_text}`);
    assertSame(JSON.parse((await saved(page, "JSON")).text), expected);
    const row = await page.$eval("output[data-identified=gs_mn_per_m]", (cell) => cell.closest("tr").innerText);
    const [low, high] = expected.gs_n_per_m_95.map((end) => (1e3 * end).toFixed(3));
    assert.ok(row.includes((1e3 * expected.gs_n_per_m).toFixed(3)) && row.includes(`${low} to ${high}`), row);
    assert.ok(Math.abs(expected.ca / TRUTH.ca - 1) < 0.03, "it is the capsule that the outline was made of");
    await page.waitForFunction(() => /half=25.*vel=5.*visc=0.8/.test(window.location.hash));
  });

  onPage("lies over the section and marks the map", VIEW + SETUP, async (page) => {
    await drop(page, "outline.csv", TEXT);
    await identified(page);
    assert.ok(await page.isVisible("#measured-key"), "the legend names it");
    const { ca, confinement } = identify(written("outline.csv", TEXT));
    await page.getByRole("button", { name: "Show this capsule" }).click();
    await settled(page);
    const state = await page.evaluate(() => window.capsuleExplorer.state);
    assert.ok(Math.abs(state.ca / ca - 1) < 1e-5 && Math.abs(state.confinement / confinement - 1) < 1e-5);
    assert.equal(state.t, 20);
    assert.deepEqual(state.dimensions.slice(0, 2), [50, 800]);
    // The capsule on screen is the fitted one: both outlines lie on each other.
    const [measured, shown] = await page.evaluate(() =>
      [".measured-outline", ".membrane"].map((line) => {
        const drawn = document.querySelector(`#midplane ${line}`);
        const { x, y, width, height } = drawn.getBBox();
        const { e, f } = drawn.getCTM();
        return [x + e, y + f, width, height];
      }),
    );
    const isNear = measured.every((side, i) => Math.abs(side - shown[i]) < 1.5);
    assert.ok(isNear, `${measured} and ${shown}`);
    await page.waitForFunction(() => /misfit 0\.0 /.test(document.querySelector("#measured-live").textContent));
    await page.waitForSelector("#map .region-of >> nth=1", { state: "attached" });
    // At once: each new row of the misfit draws the map anew.
    const [mark, point] = await page.evaluate(() =>
      [".best-fit", ".point"].map((part) => document.querySelector(`#map ${part}`).getBoundingClientRect().toJSON()),
    );
    assert.ok(Math.abs(mark.x + mark.width / 2 - point.x - point.width / 2) < 1, "the best fit is where the point is");
  });

  onPage("is pasted as text; an open end and the silhouette are the command's too", VIEW + SETUP, async (page) => {
    const part = TEXT.split("\n").slice(0, -12).join("\n");
    await page.evaluate((text) => {
      const clipboardData = new DataTransfer();
      clipboardData.setData("text/plain", text);
      document.body.dispatchEvent(new ClipboardEvent("paste", { clipboardData, bubbles: true }));
    }, part);
    await identified(page);
    const file = written("part.csv", part);
    assertSame(JSON.parse((await saved(page, "JSON")).text), identify(file));
    await page.getByLabel("The outline is").selectOption("silhouette");
    await page.getByLabel("Direction of the flow").selectOption("right");
    await page.waitForFunction(() => document.querySelector("output[data-identified]") === null);
    await identified(page);
    const expected = identify(file, ["-o", "silhouette", "--flow", "right"]);
    assertSame(JSON.parse((await saved(page, "JSON")).text), expected);
  });
});

describe("a picture", () => {
  onPage("that is pasted gives the command's answer", VIEW + SETUP, async (page) => {
    const bytes = picture(POINTS);
    const expected = identify(written("capsule.png", bytes), ["-o", "midplane", "--channel", "square"]);
    assert.ok(Math.abs(expected.ca / TRUTH.ca - 1) < 0.2, `${expected.ca}`);
    await page.evaluate((base64) => {
      const image = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
      const clipboardData = new DataTransfer();
      clipboardData.items.add(new File([image], "image.png", { type: "image/png" }));
      document.body.dispatchEvent(new ClipboardEvent("paste", { clipboardData, bubbles: true }));
    }, bytes.toString("base64"));
    await identified(page);
    assertSame(JSON.parse((await saved(page, "JSON")).text), expected);
    // The walls of the picture lie on those of the section.
    const [image, walls] = await page.evaluate(() => {
      const { height } = document.querySelector("#midplane .measured-picture").getBoundingClientRect();
      const lines = [...document.querySelectorAll("#midplane .wall")].map((line) => line.getBoundingClientRect().y);
      return [height, Math.abs(lines[1] - lines[0])];
    });
    const { walls_px: apart } = expected.picture;
    assert.ok(Math.abs((image / 160) * apart - walls) < 0.02 * walls, `${image} px, walls ${walls} px apart`);
  });
});

describe("a file that holds no outline", () => {
  onPage("is named, what is typed mends it, and the next one is answered", VIEW + SETUP, async (page) => {
    const few = TEXT.split("\n").slice(0, 6).join("\n");
    const wide = pointsText(POINTS.map((point) => point.map((at) => 1.4 * at)));
    const pixels = TEXT.replace("x_um,y_um", "x_px,y_px");
    for (const [name, content, words] of [
      ["few.csv", few, /5 points: at least 12 are needed/],
      ["noise.png", "no picture", /cannot be read as PNG, JPEG or TIFF/],
      ["word.csv", `${TEXT}nine,4\n`, /"nine" is no number/],
      ["wide.csv", wide, /um wide, the channel 50/],
      ["px.csv", pixels, /in pixels: give the size of a pixel/],
    ]) {
      await drop(page, name, content);
      await page.waitForFunction(
        ([file, source]) =>
          document.querySelector("#measured-file").textContent === file &&
          new RegExp(source).test(document.querySelector("#measured-verdict.problem")?.textContent ?? ""),
        [name, words.source],
      );
      assert.equal(await page.locator("#map .best-fit").count(), 0);
    }
    await page.getByLabel("Size of a pixel, µm").fill("1");
    await identified(page);
    await page.getByLabel("Size of a pixel, µm").fill("");
    await drop(page, "outline.csv", TEXT);
    await page.waitForFunction(() => document.querySelector("#measured-file").textContent === "outline.csv");
    await identified(page);
  });
});

test("a model of something else takes no outline", async () => {
  const model = otherModel();
  const { page, close } = await open(VIEW + SETUP);
  await drop(page, "outline.csv", TEXT);
  await identified(page);
  await page.setInputFiles("#model-file", model);
  await page.waitForFunction(() => document.body.dataset.model === "other");
  await settled(page);
  assert.equal(await page.isVisible("#measured-key"), false, "the answer of the other model is gone");
  assert.equal(await page.isVisible("[data-toggles=measured]"), false);
  await drop(page, "outline.csv", TEXT);
  await page.waitForFunction(() => document.body.dataset.status === "failed");
  assert.match(await page.innerText("#failure"), /takes no outlines: it is not one of capsules in the channel/);
  await close();
});

describe("files", () => {
  onPage("of an answer hold it, and name the model", VIEW + SETUP, async (page) => {
    await drop(page, "outline.csv", TEXT);
    await identified(page);
    const answer = JSON.parse((await saved(page, "JSON")).text);
    const table = await saved(page, "CSV");
    const [head, row] = table.text
      .trim()
      .split("\n")
      .map((line) => line.match(/("([^"]|"")*"|[^,]*)(,|$)/g));
    const cell = (key) => row[head.findIndex((name) => name.replace(",", "") === key)].replace(/,$/, "");
    assert.equal(Number(cell("ca")), answer.ca);
    assert.equal(Number(cell("gs_n_per_m_95_high")), answer.gs_n_per_m_95[1]);
    assert.equal(cell("model_digest"), answer.model_digest);
    const drawing = await saved(page, "SVG");
    assert.ok(drawing.name.includes(answer.model_digest) && drawing.text.includes(`Model ${answer.model_digest}`));
    const shapes = await page.evaluate((text) => {
      const parsed = new DOMParser().parseFromString(text, "image/svg+xml");
      return ["parsererror", "circle", "path"].map((name) => parsed.querySelectorAll(name).length);
    }, drawing.text);
    assert.equal(shapes[0], 0);
    assert.ok(shapes[1] >= POINTS.length && shapes[2] >= 4, shapes.join());
  });

  onPage("of a session bring the outline back", VIEW + SETUP, async (page) => {
    await drop(page, "outline.csv", TEXT);
    await identified(page);
    const answer = JSON.parse((await saved(page, "JSON")).text);
    await page.click("#open-take-away");
    const [download] = await Promise.all([
      page.waitForEvent("download"),
      page.getByRole("button", { name: "Session, to open again, Save" }).click(),
    ]);
    const again = await open();
    await again.page.setInputFiles(
      "#model-file",
      await download.path().then((path) => {
        const buffer = readFileSync(path);
        return { name: "session.json", mimeType: "application/json", buffer };
      }),
    );
    await identified(again.page);
    assert.equal(await again.page.textContent("#measured-file"), "outline.csv");
    assert.deepEqual(JSON.parse((await saved(again.page, "JSON")).text), answer);
    await again.close();
  });
});

test("the module is loaded when it is asked for, and the page goes on while it works", async () => {
  const { page, errors, close } = await open(`${VIEW + SETUP}&layer=misfit`);
  const modules = () =>
    page.evaluate(() => performance.getEntriesByType("resource").filter(({ name }) => /worker/.test(name)).length);
  assert.equal(await modules(), 0);
  // A worker that takes its time: what it says arrives when the gate opens.
  await page.evaluate(() => {
    const gate = new Promise((open) => {
      window.openGate = open;
    });
    Worker.prototype.addEventListener = function (type, listener) {
      const late = async (event) => {
        await gate;
        listener(event);
      };
      EventTarget.prototype.addEventListener.call(this, type, type === "message" ? late : listener);
    };
  });
  await drop(page, "outline.csv", TEXT);
  await page.waitForFunction(() => document.querySelector("#measured-verdict").textContent === "Identifying…");
  const before = await figures(page);
  await page.fill("#ca", "0.05");
  await page.click("#play");
  await page.waitForFunction(() => window.capsuleExplorer.state.t > 2.2);
  assert.notEqual((await figures(page)).axial_length, before.axial_length);
  assert.equal(await page.locator("output[data-identified]").count(), 0);
  await page.evaluate(() => window.openGate());
  await identified(page);
  await page.waitForFunction(() => !/computed/.test(document.querySelector("#map-legend").textContent));
  assert.ok((await page.locator("#map .contour").count()) >= 3);
  assert.equal(await modules(), 1);
  // Late answers are dropped: of two files the last one is answered.
  await drop(page, "first.csv", TEXT);
  await drop(page, "few.csv", TEXT.split("\n").slice(0, 6).join("\n"));
  await page.waitForSelector("#measured-verdict.problem");
  await page.waitForTimeout(500);
  assert.equal(await page.locator("output[data-identified]").count(), 0);
  assert.deepEqual(errors, []);
  await close();
});

describe("the misfit", () => {
  onPage("is told for the place below the mouse and for the point", `${VIEW + SETUP}&layer=misfit`, async (page) => {
    await drop(page, "outline.csv", TEXT);
    await identified(page);
    const box = await page.locator("#map-surface").boundingBox();
    await page.mouse.move(box.x + 0.35 * box.width, box.y + 0.6 * box.height);
    await page.waitForFunction(() => /misfit [\d.]+ standard/.test(document.querySelector("#map .hint").textContent));
    await page.focus("#map-point");
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction(() =>
      /misfit [\d.]+ standard/.test(document.querySelector("#map-point").getAttribute("aria-valuetext")),
    );
    assert.match(await page.textContent("#map-legend"), /misfit of the measured outline/);
  });
});
