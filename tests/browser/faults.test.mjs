// Faults that CapsuleExplorer had: links that lose what they say, files that cannot be read, numbers that are shown and
// ignored, figures that do not fit. Each stays away.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, describe, test } from "node:test";
import { crc32 } from "node:zlib";
import { explorer, FLAT, figures, MODEL, otherModel, predict, settled } from "./support.mjs";

const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

let other;

const { open, onPage, url } = explorer();

before(() => {
  other = otherModel();
});

const state = (page) => page.evaluate(() => window.capsuleExplorer.state);
const set = async (page, patch) => {
  await page.evaluate((wanted) => window.capsuleExplorer.set(wanted), patch);
  await settled(page);
};
const boxOf = (page, selector) => page.locator(selector).first().boundingBox();

/** The shipped model with another title, hence another digest. */
function retitled() {
  const file = readFileSync(MODEL);
  file.write("M", file.indexOf("icrocapsule") - 1);
  file.write("Another", file.indexOf("icrocapsule"));
  file.writeUInt32LE(crc32(file.subarray(16)), 12);
  return { buffer: file, digest: crc32(file.subarray(16)).toString(16).padStart(8, "0") };
}

describe("a link", () => {
  test("with another model names its file, and holds once that is open", async () => {
    const { buffer, digest } = retitled();
    const link = `#v=1&m=${digest}&file=own.crom&ca=0.05&al=0.8&t=7&frame=centroid${FLAT}`;
    const { page, errors, close } = await open(link);
    assert.match(await page.innerText("#banner"), new RegExp(`own\\.crom.*${digest}`));
    await page.setInputFiles("#model-file", { name: "own.crom", mimeType: "application/octet-stream", buffer });
    await page.waitForFunction((wanted) => document.querySelector("#model").dataset.digest === wanted, digest);
    const { ca, confinement, t, frame } = await state(page);
    assert.deepEqual([ca, confinement, t, frame], [0.05, 0.8, 7, "centroid"]);
    assert.equal(await page.isVisible("#banner"), false);
    await page.waitForFunction((wanted) => window.location.hash.includes(`m=${wanted}`), digest);
    assert.ok(page.url().includes("file=own.crom"));
    assert.deepEqual(errors, []);
    await close();
  });

  onPage(
    "that is pasted into an open page keeps nothing of the one before",
    `#ca=0.05&al=0.8&t=1&frame=centroid&method=paper${FLAT}`,
    async (page) => {
      assert.equal((await state(page)).frame, "centroid");
      await page.evaluate((views) => {
        window.location.hash = `#ca=0.06${views}`;
      }, FLAT);
      await page.waitForFunction(() => window.capsuleExplorer.state.ca === 0.06);
      const { frame, method, t, confinement } = await state(page);
      assert.deepEqual([frame, method, t, confinement], ["laboratory", "direct", 2, 0.9]);
    },
  );

  onPage("with parameters of another kind of model leaves later links whole", `#p=0.1,0.2${FLAT}`, async (page) => {
    assert.deepEqual((await state(page)).parameters, []);
    await set(page, { ca: 0.07 });
    await page.waitForFunction(() => window.location.hash.includes("ca=0.07"));
    assert.ok(!page.url().includes("p="));
  });

  onPage("is a step of the history after each edit", `#ca=0.05&al=0.8&t=1${FLAT}`, async (page) => {
    for (const ca of [0.06, 0.07, 0.08]) {
      await set(page, { ca });
      await page.waitForFunction((wanted) => window.location.hash.includes(`ca=${wanted}`), ca);
    }
    for (const ca of [0.07, 0.06, 0.05]) {
      await page.goBack();
      await page.waitForFunction((wanted) => window.capsuleExplorer.state.ca === wanted, ca);
    }
    await page.goForward();
    await page.waitForFunction(() => window.capsuleExplorer.state.ca === 0.06);
  });
});

describe("a file", () => {
  onPage("that cannot be read is refused with words", `#t=1${FLAT}`, async (page) => {
    await page.evaluate(() => {
      Blob.prototype.arrayBuffer = () => Promise.reject(new DOMException("a folder is no file", "NotFoundError"));
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([], "folder"));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    });
    await page.waitForFunction(() => document.body.dataset.status === "failed");
    assert.match(await page.innerText("#failure"), /folder could not be read: a folder is no file/);
  });

  onPage("that is no model is not read beyond its header", `#t=1${FLAT}`, async (page) => {
    const read = await page.evaluate(async () => {
      const { arrayBuffer } = Blob.prototype;
      const sizes = [];
      Blob.prototype.arrayBuffer = function () {
        sizes.push(this.size);
        return arrayBuffer.call(this);
      };
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([new Uint8Array(1 << 26)], "film.crom"));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
      await new Promise((wake) => setTimeout(wake, 300));
      return sizes;
    });
    assert.deepEqual(read, [16]);
    assert.match(await page.innerText("#failure"), /film\.crom is not a model/);
  });

  test("that is opened while the first model still loads stays", async () => {
    const { page: first, close } = await open("#views=midplane");
    const page = await first.context().newPage();
    let release;
    const held = new Promise((go) => {
      release = go;
    });
    await page.route("**/capsule.crom", async (route) => {
      await held;
      await route.continue();
    });
    await page.goto(`${url()}#t=1${FLAT}`);
    await page.getByText("Loading the reduced-order model").waitFor();
    const { buffer, digest } = retitled();
    await page.setInputFiles("#model-file", { name: "own.crom", mimeType: "application/octet-stream", buffer });
    await page.waitForFunction(() => document.body.dataset.status === "ready");
    assert.equal(await page.isVisible(".loading"), false);
    release();
    await page.waitForTimeout(600);
    assert.equal(await page.getAttribute("#model", "data-digest"), digest);
    await close();
  });
});

describe("numbers", () => {
  onPage("beyond the end of time go to the end and are marked", `#t=1${FLAT}`, async (page) => {
    await page.fill("#time-value", "25");
    await settled(page);
    const { t, end } = await state(page);
    assert.equal(t, end);
    assert.equal(await page.getAttribute("#time-value", "aria-invalid"), "true");
    await page.locator("#time-value").blur();
    assert.equal(Number(await page.inputValue("#time-value")), end);
    assert.equal(await page.getAttribute("#time-value", "aria-invalid"), "false");
  });

  onPage("that are none are refused by the page's interface", `#t=1${FLAT}`, async (page) => {
    const refusals = await page.evaluate(() =>
      [{ t: Number.NaN }, { ca: "0.1" }, { method: "magic" }, { taste: 1 }].map((patch) => {
        try {
          window.capsuleExplorer.set(patch);
          return "taken";
        } catch (error) {
          return error.message;
        }
      }),
    );
    assert.deepEqual(refusals.slice(0, 3), [
      "NaN is no value of t",
      "0.1 is no value of ca",
      "magic is no value of method",
    ]);
    assert.match(refusals[3], /no field taste/);
    assert.equal((await state(page)).t, 1);
  });

  onPage("that are refused are marked, and no others", `#ca=0.1&al=0.9&t=1${FLAT}`, async (page) => {
    const marked = () => page.$$eval("#inputs input", (inputs) => inputs.map((input) => input.ariaInvalid));
    await set(page, { ca: 0.9 });
    assert.deepEqual(await marked(), ["true", "false"]);
    await set(page, { ca: 0.05, confinement: 1.4 });
    assert.deepEqual(await marked(), ["false", "true"]);
    await set(page, { confinement: 0.9 });
    assert.deepEqual(await marked(), ["false", "false"]);
  });

  onPage("are in the accessible names of the read-outs", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const [instant] = predict(0.1, 0.9, [3], "direct").instants;
    const name = `Axial length ${instant.axial_length.toFixed(4)} ℓ`;
    assert.equal(await page.getByRole("radio", { name }).count(), 1);
  });
});

describe("the figures", () => {
  onPage("are not covered by the notice", "#ca=0.9&al=0.9", async (page) => {
    const notice = await boxOf(page, "#notice");
    assert.ok(notice.height > 20);
    for (const selector of ["#solid", "#map", "#transversal"]) {
      const box = await boxOf(page, selector);
      const apart =
        notice.y + notice.height <= box.y ||
        box.y + box.height <= notice.y ||
        notice.x + notice.width <= box.x ||
        box.x + box.width <= notice.x;
      assert.ok(apart, `${selector} is in sight`);
    }
  });

  onPage("in space have z upwards: the cut by z = 0 lies flat", "#ca=0.1&al=0.9&t=4&initial=0", async (page) => {
    await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
    const [width, height] = await page.evaluate(() => {
      window.capsuleExplorer.set({ t: 4.1 });
      window.capsuleExplorer.read();
      const picture = document.querySelector("#solid canvas");
      const canvas = new OffscreenCanvas(picture.width, picture.height);
      const context = canvas.getContext("2d");
      context.drawImage(picture, 0, 0);
      const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
      const [xs, ys] = [[], []];
      for (let i = 0; i < data.length; i += 4) {
        const [r, g, b, a] = data.subarray(i, i + 4);
        if (a > 200 && b > 140 && r < 60 && g < 130) {
          xs.push((i / 4) % canvas.width);
          ys.push(Math.floor(i / 4 / canvas.width));
        }
      }
      const span = (values) => Math.max(...values) - Math.min(...values);
      return [span(xs), span(ys)];
    });
    assert.ok(width > 2 * height, `${width} px wide, ${height} px high`);
  });

  onPage("come back after the graphics context is lost", "#ca=0.1&al=0.9&t=3&initial=0&views=solid", async (page) => {
    await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
    await page.evaluate(() => {
      window.lose = document.querySelector("#solid canvas").getContext("webgl2").getExtension("WEBGL_lose_context");
      window.lose.loseContext();
    });
    await page.waitForSelector("#solid .missing");
    assert.match(await page.innerText("#solid .missing"), /graphics card/);
    await page.evaluate(() => window.lose.restoreContext());
    await page.waitForFunction(() => document.querySelector("#solid .missing") === null);
    await page.evaluate(() => {
      const context = document.querySelector("#solid canvas").getContext("webgl2");
      context.getExtension("WEBGL_lose_context").loseContext();
    });
    await page.click("#solid .missing button");
    await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
    assert.equal(await page.locator("#solid canvas").count(), 1);
  });

  onPage("along the channel move without jumps", `#ca=0.1&al=0.9&t=0${FLAT}`, async (page) => {
    const steps = await page.evaluate(async () => {
      const places = [];
      for (let t = 0; t <= 12; t += 0.1) {
        window.capsuleExplorer.set({ t });
        window.capsuleExplorer.read();
        const { left, right } = document.querySelector("#midplane .membrane").getBoundingClientRect();
        places.push((left + right) / 2);
      }
      return places.slice(1).map((place, i) => Math.abs(place - places[i]));
    });
    assert.ok(Math.max(...steps) < 8, `largest step ${Math.max(...steps)} px`);
  });

  onPage("across can be moved beyond both ends of the longest capsule", `#ca=0.02&al=1.2&t=20${FLAT}`, async (page) => {
    for (const end of ["max", "min"]) {
      await page.locator("#section").fill(await page.getAttribute("#section", end));
      await settled(page);
      assert.match(await page.innerText("#transversal"), /misses/, `at ${end}`);
    }
    const outline = await page.evaluate(() => window.capsuleExplorer.read().axial_length);
    const [least, most] = await Promise.all(["min", "max"].map((end) => page.getAttribute("#section", end)));
    assert.ok(Number(most) - Number(least) > outline);
  });

  onPage("need one font", `#ca=0.1&al=0.9${FLAT}`, async (page) => {
    await page.evaluate(() => document.fonts.ready);
    const fonts = await page.evaluate(() =>
      performance
        .getEntriesByType("resource")
        .filter(({ name }) => name.endsWith(".woff2"))
        .map(({ name }) => name),
    );
    assert.equal(fonts.length, 1, fonts.join(", "));
  });
});

describe("a small screen", () => {
  for (const [width, height] of [
    [1366, 650],
    [1024, 768],
    [720, 450],
  ]) {
    onPage(
      `of ${width} x ${height} holds the page, and nothing covers what has the focus`,
      `#ca=0.1&al=0.9&t=1&layer=error_bound${FLAT}`,
      async (page) => {
        const [content, room] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
        assert.ok(content <= room, `${content} px of content in ${room} px`);
        const [inputs, choices, readouts] = await Promise.all(
          ["#inputs", ".choices", "#readouts"].map((part) => boxOf(page, part)),
        );
        for (const [one, other] of [
          [inputs, choices],
          [inputs, readouts],
          [choices, readouts],
        ]) {
          assert.ok(one.y + one.height <= other.y + 1 || one.x + one.width <= other.x + 1, "parts lie apart");
        }
        for (let i = 0; i < 40; i++) {
          await page.keyboard.press("Tab");
          const covered = await page.evaluate(() => {
            const { activeElement } = document;
            if (activeElement === null || activeElement === document.body || activeElement.closest(".transport"))
              return "";
            const { left, top, width, height } = activeElement.getBoundingClientRect();
            const found = document.elementFromPoint(left + width / 2, top + height / 2);
            return found?.closest(".transport, .notice") ? activeElement.outerHTML : "";
          });
          assert.equal(covered, "");
        }
      },
      { viewport: { width, height } },
    );
  }
});

describe("a phone", () => {
  onPage(
    "shows a refusal wherever one has scrolled to",
    `#ca=0.1&al=0.9&t=1${FLAT}`,
    async (page) => {
      await page.locator("#map").scrollIntoViewIfNeeded();
      await set(page, { ca: 0.9 });
      const box = await boxOf(page, "#notice");
      assert.ok(box.y >= 0 && box.y + box.height <= 844, `notice at ${box.y}`);
    },
    PHONE,
  );

  onPage(
    "does not move the plane when a finger scrolls over it",
    `#ca=0.1&al=0.9&t=1${FLAT}`,
    async (page) => {
      await page.locator("#midplane").scrollIntoViewIfNeeded();
      const box = await boxOf(page, "#midplane");
      const client = await page.context().newCDPSession(page);
      const point = (y) => [{ x: box.x + 0.7 * box.width, y }];
      const middle = box.y + box.height / 2;
      await client.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: point(middle) });
      for (let i = 1; i <= 6; i++) {
        await client.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: point(middle - 15 * i) });
      }
      await client.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
      await settled(page);
      assert.equal((await state(page)).section, 0);
      // The page rolls on for a while after the finger has left it.
      await page.waitForTimeout(600);
      await page.locator("#midplane").evaluate((stage) => stage.scrollIntoView({ block: "center" }));
      const now = await boxOf(page, "#midplane");
      await page.touchscreen.tap(now.x + 0.55 * now.width, now.y + now.height / 3);
      await settled(page);
      assert.notEqual((await state(page)).section, 0);
    },
    PHONE,
  );

  onPage(
    "holds a model of one's own in its width, with units that are words",
    `#t=1${FLAT}`,
    async (page) => {
      await page.setInputFiles("#model-file", other);
      await page.waitForFunction(() => document.body.dataset.model === "other");
      await settled(page);
      const [content, width] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
      assert.ok(content <= width, `${content} px of content in ${width} px`);
      const isOver = await page.$$eval(".readout, .readout *", (parts) =>
        parts
          .filter((part) => part.scrollWidth > part.clientWidth + 1 && part.clientWidth > 0)
          .map((part) => part.outerHTML),
      );
      assert.deepEqual(isOver, []);
    },
    PHONE,
  );
});

describe("two explorers in one document", () => {
  onPage("answer each for itself and share no id", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    await page.evaluate(() => {
      const place = document.createElement("div");
      document.body.append(place);
      const views = new Set(["midplane"]);
      window.second = window.capsuleExplorer.mount(place, {
        prefix: "second-",
        state: { ca: 0.05, confinement: 0.8, t: 6, views },
      });
    });
    await page.waitForFunction(() => document.querySelectorAll('.explorer[data-status="ready"]').length === 2);
    await settled(page);
    const ids = await page.$$eval("[id]", (parts) => parts.map(({ id }) => id));
    assert.equal(new Set(ids).size, ids.length);
    const found = await page.evaluate(() =>
      [window.capsuleExplorer, window.second].map((one) => one.read().axial_length),
    );
    const expected = [predict(0.1, 0.9, [3], "direct"), predict(0.05, 0.8, [6], "direct")];
    assert.deepEqual(
      found.map(Math.fround),
      expected.map(({ instants: [instant] }) => Math.fround(instant.axial_length)),
    );
    await page.fill("#second-ca", "0.06");
    await settled(page);
    assert.equal((await state(page)).ca, 0.1);
    assert.equal(Object.keys(await figures(page)).length, 8);
  });
});
