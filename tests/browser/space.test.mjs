// The space view: its fields are the native core's, its choices are in the link, and nothing is computed that is not
// shown.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { explorer, membraneChanged, openModel, otherModel, predict, predictFields, settled } from "./support.mjs";

// A small picture of one surface, since an emulated graphics card draws it.
const { open, onPage } = explorer({ viewport: { width: 720, height: 560 } });
const SOLID = "&views=solid&initial=0";
/** Without the bars, one of which would lie over a part of the picture. */
const ALONE = "?controls=none";

const state = (page) => page.evaluate(() => window.capsuleExplorer.state);
const rendered = (page) => page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
const extremes = (page) =>
  page.$eval("#field", ({ dataset }) => [Number(dataset.least), Number(dataset.most)].map(Math.fround));
/** The colours that can be chosen. */
const offered = (page) =>
  page.$$eval("#colour option", (all) => all.filter(({ hidden }) => !hidden).map(({ value }) => value));
const range = (values) => [Math.min(...values), Math.max(...values)].map(Math.fround);

/** Before the page's own program: counts the fields that the module is asked for. */
function countFields() {
  const { instantiateStreaming } = WebAssembly;
  window.asked = 0;
  WebAssembly.instantiateStreaming = async (...source) => {
    const { module, instance } = await instantiateStreaming(...source);
    const { evaluation_field } = instance.exports;
    const counted = (...words) => {
      window.asked++;
      return evaluation_field(...words);
    };
    return { module, instance: { exports: { ...instance.exports, evaluation_field: counted } } };
  };
}

/** Lengths of vectors x, y, z, given by columns. */
const lengths = (columns) => Array.from(columns[0], (_, i) => Math.hypot(...columns.map((column) => column[i])));
const vector = (columns, name) => ["x", "y", "z"].map((axis) => columns[name === "" ? axis : `${name}_${axis}`]);

function close(found, expected, name) {
  assert.equal(found.length, expected.length, name);
  for (const [i, value] of expected.entries()) {
    assert.ok(Math.abs(found[i] - value) <= 1e-6 * Math.max(1, Math.abs(value)), `${name} ${i}: ${found[i]}, ${value}`);
  }
}

describe("a field at the nodes", () => {
  for (const method of ["direct", "paper"]) {
    test(`is the native core's, by the method ${method}`, async () => {
      const evaluation = (await openModel()).evaluation();
      evaluation.prepare([0.1, 0.9], method, false);
      evaluation.goTo(3);
      const native = predictFields(0.1, 0.9, 3, method);
      for (const name of ["stretch_1", "stretch_2", "tension_1", "tension_2", "energy_density"]) {
        assert.deepEqual(evaluation.field(name, "laboratory"), native[name], name);
        assert.deepEqual(evaluation.field(name, "centroid"), native[name], name);
      }
      close(evaluation.field("load", "centroid"), lengths(vector(native, "load")), "load");

      const [x, y, z] = vector(native, "velocity");
      close(evaluation.field("velocity", "laboratory"), lengths([x, y, z]), "velocity");
      const [{ velocity }] = predict(0.1, 0.9, [3], method).instants;
      close(evaluation.field("velocity", "centroid"), lengths([x.map((v) => v - velocity), y, z]), "relative velocity");

      const start = vector(predictFields(0.1, 0.9, 0, method), "");
      const moved = vector(native, "").map((column, axis) => column.map((at, i) => at - start[axis][i]));
      close(evaluation.field("displacement", "laboratory"), lengths(moved), "displacement");
      // The question about the start leaves the evaluation where it was.
      const travelled = evaluation.centroid();
      evaluation.goTo(0);
      const advance = travelled - evaluation.centroid();
      evaluation.goTo(3);
      const deformed = [moved[0].map((u) => u - advance), moved[1], moved[2]];
      close(evaluation.field("displacement", "centroid"), lengths(deformed), "displacement in the centroid's frame");
    });
  }

  test("is refused by an unknown name or frame, and before a query", async () => {
    const evaluation = (await openModel()).evaluation();
    assert.throws(() => evaluation.field("load", "centroid"), /before a query was prepared/);
    evaluation.prepare([0.1, 0.9], "direct", false);
    assert.throws(() => evaluation.field("heat", "centroid"), /"heat" is unknown; there are displacement, /);
    assert.throws(() => evaluation.field("load", "moon"), /"moon" is unknown; there are laboratory and centroid/);
  });
});

describe("the colours", () => {
  onPage("have a scale with the field's values, on all capsules", `#ca=0.1&al=0.9&t=3${SOLID}`, async (page) => {
    await rendered(page);
    assert.equal(await page.isVisible("#field"), false);
    const plain = await page.locator("#solid canvas").screenshot();
    await page.selectOption("#colour", "tension_1");
    await settled(page);
    const live = predictFields(0.1, 0.9, 3, "direct");
    assert.deepEqual(await extremes(page), range(live.tension_1));
    assert.ok(!plain.equals(await page.locator("#solid canvas").screenshot()), "the membrane has other colours");
    assert.match(await page.getAttribute("#field svg", "aria-label"), /^Colours: Tension T₁, 0\.\d+ to 0\.\d+ G_s$/);
    // On both sides of 0 as far as the greater of the two.
    const ends = await page.$$eval("#field text", (texts) => texts.map(({ textContent }) => textContent).slice(1));
    assert.deepEqual([ends[0], ends[1]], [`−${ends[2]}`, "0"]);
    assert.ok(Math.abs(Number(ends[2]) - range(live.tension_1)[1]) < 0.006, ends.join());

    await page.evaluate(() =>
      window.capsuleExplorer.set({
        colour: "stretch_2",
        pins: [{ name: "A", parameters: [0.05, 0.8], method: "paper", extrapolate: false }],
      }),
    );
    await settled(page);
    const both = [...live.stretch_2, ...predictFields(0.05, 0.8, 3, "paper").stretch_2];
    assert.deepEqual(await extremes(page), range(both));
  });

  onPage("have physical units with an experiment's sizes", `#ca=0.1&al=0.9&t=3&dims=60,2,30${SOLID}`, async (page) => {
    await page.selectOption("#colour", "load");
    await rendered(page);
    await settled(page);
    // mu V / l = 2 mPa s * 0.1 * 30 mN/m / (2 mPa s) / 30 um = 100 Pa.
    const [, most] = range(lengths(vector(predictFields(0.1, 0.9, 3, "direct"), "load")));
    const label = await page.getAttribute("#field svg", "aria-label");
    const shown = Number(/to (\d+) Pa$/.exec(label)[1]);
    assert.ok(Math.abs(shown - 100 * most) < 1, `${label}, natively ${100 * most}`);
  });

  onPage(
    "keep a scale that is held, and so does the link",
    `#ca=0.1&al=0.9&t=3&colour=velocity${SOLID}`,
    async (page) => {
      await rendered(page);
      await page.check("#hold-range");
      const { range: held } = await state(page);
      assert.deepEqual(held.map(Math.fround), await extremes(page));
      await page.evaluate(() => window.capsuleExplorer.set({ t: 0.3, clip: "z", camera: "side" }));
      await settled(page);
      const ends = () => page.$$eval("#field text", (texts) => texts.map(({ textContent }) => textContent));
      const shown = await ends();
      await page.waitForFunction(() => /clip=z/.test(window.location.hash));
      const again = await open(new URL(page.url()).hash);
      await rendered(again.page);
      assert.deepEqual(
        await again.page.$$eval("#field text", (texts) => texts.map(({ textContent }) => textContent)),
        shown,
      );
      const { colour, clip, camera } = await state(again.page);
      assert.deepEqual([colour, clip, camera], ["velocity", "z", "side"]);
      await again.close();
      await page.selectOption("#colour", "displacement");
      await settled(page);
      assert.deepEqual((await state(page)).range, []);
    },
  );

  test("cost nothing where they are not shown", async () => {
    const { page, close } = await open("#views=midplane", { before: countFields });
    const asked = async (address) => {
      await page.goto("about:blank");
      await page.goto(address);
      await page.waitForFunction(() => document.body.dataset.status === "ready");
      await settled(page);
      for (const t of [4, 5]) {
        await page.evaluate((at) => window.capsuleExplorer.set({ t: at }), t);
        await settled(page);
      }
      return page.evaluate(() => window.asked);
    };
    const address = page.url().replace(/#.*/, "");
    assert.equal(await asked(`${address}#t=3${SOLID}`), 0);
    assert.equal(await asked(`${address}#t=3&colour=load&views=midplane`), 0);
    const before = await asked(`${address}#t=3&colour=load${SOLID}`);
    assert.ok(before >= 1 && before <= 3, `${before} fields for three instants`);
    await close();
  });

  onPage("are those that a model of other data has", `#t=1${SOLID}`, async (page) => {
    await page.setInputFiles("#model-file", otherModel());
    await page.waitForFunction(() => document.body.dataset.model === "other");
    await settled(page);
    assert.deepEqual(await offered(page), ["none", "displacement", "velocity"]);
    await page.selectOption("#colour", "velocity");
    await rendered(page);
    await page.waitForFunction(() => !document.querySelector("#field").hidden);
    assert.match(await page.getAttribute("#field svg", "aria-label"), /Velocity in the laboratory frame/);
    // A link may ask for mechanics, which is not known without a stress-free state.
    await page.evaluate(() => window.capsuleExplorer.set({ colour: "tension_1" }));
    await settled(page);
    assert.equal(await page.isVisible("#field"), false);
  });

  onPage("are no tensions of a membrane with another law", `#t=1${SOLID}`, async (page) => {
    const buffer = membraneChanged("some-law-01", 2.5e-3);
    const evaluation = (await openModel(buffer)).evaluation();
    evaluation.prepare([0.1, 0.9], "direct", false);
    assert.throws(() => evaluation.field("tension_1", "centroid"), { code: "unsupported-reference" });
    await page.setInputFiles("#model-file", { name: "own.crom", mimeType: "application/octet-stream", buffer });
    await page.waitForFunction(() => document.querySelector("#model").textContent.includes("some-law-01"));
    await settled(page);
    assert.deepEqual(await offered(page), ["none", "displacement", "velocity"]);
    await page.evaluate(() => window.capsuleExplorer.set({ colour: "tension_1" }));
    await settled(page);
    assert.equal(await page.isVisible("#field"), false);
  });
});

describe("the picture", () => {
  onPage(
    "is seen from places that buttons and keys go to, z upwards",
    `${ALONE}#ca=0.1&al=0.9&t=3${SOLID}`,
    async (page) => {
      await rendered(page);
      const canvas = page.locator("#solid canvas");
      const picture = async () => {
        await settled(page);
        // Without the mark of what has the focus.
        await page.evaluate(() => document.activeElement.blur());
        return canvas.screenshot();
      };
      const oblique = await picture();
      await page.keyboard.press("2");
      const side = await picture();
      assert.equal((await state(page)).camera, "side");
      await page.getByRole("button", { name: "Front" }).click();
      const front = await picture();
      assert.ok(!side.equals(oblique) && !front.equals(side) && !front.equals(oblique));
      await page.keyboard.press("2");
      assert.ok(side.equals(await picture()), "the same place gives the same picture");
      // Turned by hand, the same button leads back.
      await canvas.focus();
      await page.keyboard.press("ArrowLeft");
      assert.ok(!side.equals(await picture()));
      await page.getByRole("button", { name: "Side" }).click();
      assert.ok(side.equals(await picture()));
    },
  );

  onPage("is cut open by a plane", `${ALONE}#ca=0.1&al=0.9&t=3&camera=front${SOLID}`, async (page) => {
    await rendered(page);
    /** Shares of the pixels of the lower and of the upper half that are not as in the whole picture. */
    const changes = (before, after) =>
      page.evaluate(
        async ([from, to]) => {
          const pixels = async (data) => {
            const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
            const bitmap = await createImageBitmap(new Blob([bytes]));
            const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
            context.drawImage(bitmap, 0, 0);
            return context.getImageData(0, 0, bitmap.width, bitmap.height);
          };
          const [a, b] = [await pixels(from), await pixels(to)];
          const found = { top: 0, bottom: 0, left: 0, right: 0 };
          for (let i = 0; i < a.data.length; i += 4) {
            if ([0, 1, 2].every((k) => Math.abs(a.data[i + k] - b.data[i + k]) < 12)) continue;
            const [x, y] = [(i / 4) % a.width, Math.floor(i / 4 / a.width)];
            found[y < a.height / 2 ? "top" : "bottom"]++;
            found[x < a.width / 2 ? "left" : "right"]++;
          }
          return found;
        },
        [before, after].map((picture) => picture.toString("base64")),
      );
    const canvas = page.locator("#solid canvas");
    const whole = await canvas.screenshot();
    await page.selectOption("#clip", "z");
    await settled(page);
    const z = await changes(whole, await canvas.screenshot());
    assert.ok(z.top > 1000 && z.bottom < z.top / 10, `z: ${JSON.stringify(z)}`);
    await page.selectOption("#clip", "y");
    await settled(page);
    // From the front y points to the right: the half y < 0, which is nearer from the oblique place, is left out.
    const y = await changes(whole, await canvas.screenshot());
    assert.ok(y.left > 1000 && y.right < y.left / 10, `y: ${JSON.stringify(y)}`);
    await page.selectOption("#clip", "none");
    await settled(page);
    assert.equal((await changes(whole, await canvas.screenshot())).bottom, 0);
  });
});
