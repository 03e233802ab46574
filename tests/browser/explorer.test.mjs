// CapsuleExplorer in Chromium: its figures equal the native core's, its controls work, its link restores the state, and
// the console stays silent.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { describe, test } from "node:test";
import {
  capsuleRom,
  explorer,
  FLAT,
  figures,
  openPage,
  otherModel,
  predict,
  QUANTITIES,
  settled,
  startBrowser,
} from "./support.mjs";

const PAGE = JSON.parse(readFileSync(new URL("../../wasm/explorer/package.json", import.meta.url), "utf8"));

const { open, onPage, url } = explorer();

async function fill(page, id, value) {
  await page.fill(`#${id}`, String(value));
  await settled(page);
}

const state = (page) => page.evaluate(() => window.capsuleExplorer.state);

describe("figures", () => {
  for (const method of ["direct", "paper"]) {
    onPage(`are the native core's, to the bit, by the method ${method}`, `#t=1${FLAT}`, async (page) => {
      const times = [0.4, 3, 6, 9];
      const native = predict(0.1, 0.9, times, method);
      assert.equal(await page.getAttribute("#model", "data-digest"), native.model_digest);
      await fill(page, "ca", 0.1);
      await fill(page, "confinement", 0.9);
      await page.check(`input[name=method][value=${method}]`, { force: true });
      for (const [i, t] of times.entries()) {
        await fill(page, "time-value", t);
        const shown = await figures(page);
        for (const quantity of QUANTITIES) {
          const expected = native.instants[i][quantity];
          assert.equal(Math.fround(shown[quantity]), Math.fround(expected), `${quantity} at t = ${t}`);
        }
      }
    });
  }

  onPage(
    "change with the parameters, and volume stays that of the sphere",
    `#ca=0.05&al=0.8&t=1${FLAT}`,
    async (page) => {
      for (const confinement of [0.8, 0.9, 1]) {
        await fill(page, "confinement", confinement);
        const { volume } = await figures(page);
        const sphere = (4 / 3) * Math.PI * confinement ** 3;
        assert.ok(Math.abs(volume / sphere - 1) < 0.02, `volume ${volume}, sphere ${sphere}`);
      }
    },
  );

  onPage("do not depend on the views that are open", "#ca=0.05&al=0.9&t=2&initial=0", async (page) => {
    const all = await figures(page);
    for (const view of ["solid", "midplane", "diagonal", "transversal"]) {
      await page.click(`[data-toggles=${view}]`);
      await settled(page);
      assert.equal(await page.isVisible(`figure[data-view=${view}]`), false);
    }
    assert.deepEqual(await figures(page), all);
  });
});

describe("the map", () => {
  onPage("chooses where it is clicked and dragged", `#ca=0.05&al=0.8&t=1${FLAT}`, async (page) => {
    const box = await page.locator("#map-surface").boundingBox();
    const first = await state(page);
    await page.mouse.click(box.x + 0.3 * box.width, box.y + 0.4 * box.height);
    await settled(page);
    const clicked = await state(page);
    assert.notDeepEqual([clicked.ca, clicked.confinement], [first.ca, first.confinement]);
    assert.equal(await page.inputValue("#ca"), String(clicked.ca));
    const point = await page.locator("#map-point").boundingBox();
    const [x, y] = [point.x + point.width / 2, point.y + point.height / 2];
    assert.ok(Math.abs(x - box.x - 0.3 * box.width) < 3 && Math.abs(y - box.y - 0.4 * box.height) < 3);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 20, y + 30, { steps: 4 });
    await page.mouse.up();
    await settled(page);
    const dragged = await state(page);
    assert.ok(dragged.ca < clicked.ca && dragged.confinement < clicked.confinement);
  });

  onPage("moves by arrow keys, finer with Shift", `#ca=0.05&al=0.8&t=1${FLAT}`, async (page) => {
    await page.focus("#map-point");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowUp");
    await page.keyboard.press("Shift+ArrowRight");
    await settled(page);
    const { ca, confinement } = await state(page);
    assert.deepEqual([ca, confinement], [0.056, 0.81]);
    assert.equal(await page.getAttribute("#map-point", "aria-valuetext"), "Ca 0.056, a/l 0.81");
  });

  onPage(
    "answers to a tap",
    `#ca=0.05&al=0.8&t=1${FLAT}`,
    async (page) => {
      const surface = page.locator("#map-surface");
      await surface.scrollIntoViewIfNeeded();
      const box = await surface.boundingBox();
      await page.touchscreen.tap(box.x + 0.25 * box.width, box.y + 0.35 * box.height);
      await settled(page);
      assert.notEqual((await state(page)).confinement, 0.8);
    },
    { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
  );
});

describe("time", () => {
  onPage("plays and pauses by the space bar and the button", `#ca=0.05&al=0.9&t=1&speed=2${FLAT}`, async (page) => {
    await page.keyboard.press("Space");
    await page.waitForFunction(() => window.capsuleExplorer.state.t > 1.2);
    assert.equal(await page.getAttribute("#play", "aria-pressed"), "true");
    assert.equal(await page.getAttribute("#play", "aria-label"), "Pause");
    await page.click("#play");
    const paused = await state(page);
    await page.waitForTimeout(150);
    assert.equal((await state(page)).t, paused.t);
    assert.equal(paused.playing, false);
  });

  onPage("is scrubbed along its axis, by arrow keys and by number", `#ca=0.05&al=0.9&t=1${FLAT}`, async (page) => {
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("Shift+ArrowRight");
    assert.equal((await state(page)).t, 2.1);
    await page.focus("#time");
    await page.keyboard.press("ArrowLeft");
    assert.equal((await state(page)).t, 2);
    const box = await page.locator("#time").boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await settled(page);
    const { t, end } = await state(page);
    assert.ok(Math.abs(t - end / 2) < 0.05, `middle of the axis is t = ${t}`);
    assert.equal(Number(await page.getAttribute("#time-value", "data-value")), t);
  });

  onPage("ends where the model ends", `#ca=0.05&al=0.9&t=1&speed=5${FLAT}`, async (page) => {
    const { end } = await state(page);
    await page.evaluate((t) => window.capsuleExplorer.set({ t, playing: true }), end - 0.2);
    await page.waitForFunction(() => !window.capsuleExplorer.state.playing);
    assert.equal((await state(page)).t, end);
  });
});

describe("parameters outside", () => {
  onPage("are refused with words and a way back", `#ca=0.05&al=0.9&t=1${FLAT}`, async (page) => {
    await fill(page, "ca", 0.9);
    assert.equal(await page.getAttribute("body", "data-answer"), "refused");
    assert.match(await page.innerText("#notice"), /0\.9/);
    assert.deepEqual(await figures(page), {});
    assert.equal(await page.getAttribute("#ca", "aria-invalid"), "true");
    await page.click("#notice button:first-of-type");
    await settled(page);
    assert.equal(await page.getAttribute("body", "data-answer"), "given");
    assert.equal(Object.keys(await figures(page)).length, QUANTITIES.length);
    assert.equal(await page.innerText("#notice"), "");
  });

  onPage("that are no numbers for a channel are refused", `#ca=-0.1&al=0.9&t=1${FLAT}`, async (page) => {
    assert.equal(await page.getAttribute("body", "data-answer"), "refused");
    assert.match(await page.innerText("#notice"), /-0\.1/);
  });
});

describe("the link", () => {
  onPage("restores the state", `#ca=0.05&al=0.8&t=1${FLAT}`, async (page) => {
    await fill(page, "ca", 0.061);
    await fill(page, "confinement", 0.83);
    await fill(page, "time-value", 2.3);
    await page.check("input[name=frame][value=centroid]", { force: true });
    await page.check("input[name=method][value=paper]", { force: true });
    await page.selectOption("#speed", "0.5");
    await page.click("[data-toggles=diagonal]");
    await page.click("#velocity");
    await page.waitForFunction(() => window.location.hash.includes("velocity"));
    const { playing: _, ...wanted } = await readState(page);
    const shown = await figures(page);
    const again = await open(new URL(page.url()).hash);
    const { playing: __, ...found } = await readState(again.page);
    assert.deepEqual(found, wanted);
    assert.deepEqual(await figures(again.page), shown);
    assert.deepEqual(again.errors, []);
    await again.close();
  });

  onPage(
    "that makes no sense in part is taken for the rest",
    `#ca=abc&al=0.8&t=-3&method=magic&speed=17${FLAT}`,
    async (page) => {
      const found = await state(page);
      assert.equal(found.confinement, 0.8);
      assert.equal(found.ca, 0.1);
      assert.equal(found.t, 0);
      assert.equal(found.speed, 1);
    },
  );
});

async function readState(page) {
  return page.evaluate(() => ({ ...window.capsuleExplorer.state, views: [...window.capsuleExplorer.state.views] }));
}

describe("the sections", () => {
  onPage("move with the plane, and say when it misses the capsule", `#ca=0.05&al=0.8&t=1${FLAT}`, async (page) => {
    const curve = () => page.getAttribute("#transversal .membrane", "d");
    const middle = await curve();
    await page.locator("#section").fill("0.5");
    await settled(page);
    assert.notEqual(await curve(), middle);
    await page.locator("#section").fill("1.5");
    await settled(page);
    assert.equal(await curve(), "");
    assert.match(await page.innerText("#transversal"), /misses/);
  });

  onPage("draw the capsule in space too", "#ca=0.05&al=0.9&t=1&initial=0", async (page) => {
    const picture = await page.locator("#solid canvas").screenshot();
    assert.ok(picture.length > 10_000, `the space view is not blank: ${picture.length} bytes`);
    for (const view of ["midplane", "diagonal"]) {
      const outline = await page.getAttribute(`#${view} .membrane`, "d");
      assert.ok(outline.split("S").length > 20, `${view} is an outline of many pieces`);
    }
  });
});

describe("a model of other people's data", () => {
  onPage("has a slider for each parameter and the native core's figures", `#t=1${FLAT}`, async (page) => {
    const model = otherModel();
    await page.setInputFiles("#model-file", model);
    await page.waitForFunction(() => document.body.dataset.model === "other");
    await settled(page);
    assert.equal(await page.locator("#sliders input[type=range]").count(), 2);
    assert.equal(await page.isVisible("#map"), false);
    await fill(page, "parameter-0", 0.05);
    await fill(page, "parameter-1", 0.87);
    assert.deepEqual((await state(page)).parameters, [0.05, 0.87]);
    const query = ["--model", model, "--parameters", "ca=0.05,al=0.87", "--t", "1", "--method", "direct", "--json"];
    const native = JSON.parse(capsuleRom(["predict", ...query]));
    assert.equal(await page.getAttribute("#model", "data-digest"), native.model_digest);
    const shown = await figures(page);
    for (const quantity of QUANTITIES) {
      // Natively other people's models are computed in double precision; in single, sums take 16-bit whole numbers.
      const [found, expected] = [shown[quantity], native.instants[0][quantity]];
      assert.ok(Math.abs(found - expected) < 1e-4, `${quantity}: ${found}, natively ${expected}`);
    }
    const errors = await page.innerText("#errors");
    assert.ok(errors.includes(`against ${native.errors_against}`), errors);
    assert.match(errors, /mean distance of the nodes/);
    assert.doesNotMatch(errors, /full-order|Hausdorff/);
    assert.match(await page.innerText("#readouts"), /length unit/);
    await page.waitForFunction(() => window.location.hash.includes("p=0.05"));
    await fill(page, "parameter-1", 1.1);
    assert.match(await page.innerText("#notice"), /al = 1\.1/i);
    await page.click("#notice button:first-of-type");
    await settled(page);
    assert.deepEqual((await state(page)).parameters, [0.05, 0.9]);
  });
});

describe("what is out of sight", () => {
  const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
  onPage(
    "is not drawn until it is scrolled to",
    `#ca=0.05&al=0.9&t=1${FLAT}`,
    async (page) => {
      const outline = () => page.getAttribute("#diagonal .membrane", "d");
      await page.evaluate(() => window.capsuleExplorer.set({ t: 2 }));
      await settled(page);
      const unseen = await outline();
      await page.evaluate(() => window.capsuleExplorer.set({ t: 3 }));
      await settled(page);
      assert.equal(await outline(), unseen, "nobody looks, nothing is drawn");
      await page.locator("#diagonal").scrollIntoViewIfNeeded();
      await page.waitForFunction(
        (before) => document.querySelector("#diagonal .membrane").getAttribute("d") !== before,
        unseen,
      );
    },
    phone,
  );
});

describe("the licences", () => {
  onPage("of all that the page bundles are behind its link", `#t=1${FLAT}`, async (page) => {
    const file = new URL(await page.getAttribute("#model a", "href"), url());
    const text = await (await fetch(file)).text();
    const packages = Object.keys(PAGE.dependencies);
    assert.ok(packages.length > 2);
    for (const name of [...packages, "Rust standard library", "libm", "postcard", "wasm-bindgen"]) {
      assert.ok(text.includes(`## ${name} - `), name);
    }
    assert.ok(text.includes("SIL OPEN FONT LICENSE") && text.includes("Permission is hereby granted"));
  });
});

describe("without", () => {
  test("a model the page says what is missing and what would help", async () => {
    const { page, close } = await open("?model=./nothing.crom");
    assert.equal(await page.getAttribute("body", "data-status"), "failed");
    assert.match(await page.innerText("#failure"), /nothing\.crom is missing[\s\S]*cargo xtask explore/);
    await close();
  });

  test("a sound model the page repeats the core's reason", async () => {
    const { page, errors, close } = await open(`#t=1${FLAT}`);
    const file = (buffer) => ({ name: "broken.crom", mimeType: "application/octet-stream", buffer });
    const model = Buffer.from(await (await fetch(`${url()}capsule.crom`)).arrayBuffer());
    const damaged = Buffer.from(model);
    damaged[damaged.length >> 1] ^= 1;
    for (const [buffer, reason] of [
      [Buffer.from("no model"), /broken\.crom/],
      [model.subarray(0, model.length - 100), /truncated/],
      [damaged, /CRC-32/],
    ]) {
      await page.setInputFiles("#model-file", file(buffer));
      await page.waitForFunction(() => document.body.dataset.status === "failed");
      assert.match(await page.innerText("#failure"), reason);
      await page.click("#failure button");
      assert.equal(await page.getAttribute("body", "data-status"), "ready");
    }
    await page.setInputFiles("#model-file", file(damaged));
    await page.waitForFunction(() => document.body.dataset.status === "failed");
    // A valid file that is dropped on the page opens.
    await page.evaluate(async () => {
      const bytes = await (await fetch("capsule.crom")).arrayBuffer();
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([bytes], "dropped.crom"));
      for (const type of ["dragover", "drop"]) {
        const event = new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true });
        document.body.dispatchEvent(event);
        if (!event.defaultPrevented) throw new Error(`${type} is left to the browser`);
        const isShown = document.body.hasAttribute("data-dropping");
        if (isShown !== (type === "dragover")) throw new Error(`${type}: shown ${isShown}`);
      }
    });
    await page.waitForFunction(() => document.body.dataset.status === "ready");
    await settled(page);
    assert.equal(Object.keys(await figures(page)).length, QUANTITIES.length);
    assert.deepEqual(errors, []);
    await close();
  });

  test("WebGL the sections and figures still work", async () => {
    const plain = await startBrowser(["--disable-gpu", "--disable-3d-apis"]);
    try {
      const { page } = await openPage(plain, url());
      assert.equal(await page.getAttribute("body", "data-status"), "ready");
      // The view's program is loaded when it is first drawn.
      assert.match(await page.innerText("#solid .missing"), /WebGL/);
      assert.equal(Object.keys(await figures(page)).length, QUANTITIES.length);
      assert.ok((await page.getAttribute("#midplane .membrane", "d")).length > 100);
    } finally {
      await plain.close();
    }
  });
});
