// CapsuleExplorer in Firefox and WebKitGTK, where they are installed: `npm run other-browsers`, after
// `cargo xtask explore --build-only`. The pictures that it takes are for the eye: target/other-browsers.

import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, describe, test } from "node:test";
import { BROWSERS, missing, startDriven } from "./drivers.mjs";
import { assertSame, drop, identified, identify, picture, pointsText, SETUP, section } from "./outlines.mjs";
import { serveFolder } from "./static-server.mjs";
import { DIST, FLAT, figures, otherModel, predict, predictFields, QUANTITIES, ROOT, settled } from "./support.mjs";

const PICTURES = resolve(ROOT, "target/other-browsers");
const WIDE = [1366, 768];
const NARROW = [394, 768];

/** Runs in the page before its own program: keeps what goes wrong, since WebDriver does not tell it. */
function listen() {
  window.heardErrors = [];
  const hear = (words) => window.heardErrors.push(String(words));
  const { error } = console;
  console.error = (...words) => {
    hear(words.join(" "));
    error(...words);
  };
  window.addEventListener("error", ({ message, target }) => hear(message ?? target.outerHTML), { capture: true });
  window.addEventListener("unhandledrejection", ({ reason }) => hear(reason));
  window.addEventListener("securitypolicyviolation", ({ blockedURI }) => hear(`the policy forbids ${blockedURI}`));
}

/** The first program that the page loads begins with `listen`. */
const withListener = (name, bytes) =>
  name === "opened-as-file.js" ? Buffer.concat([Buffer.from(`(${listen})();\n`), bytes]) : bytes;

const serve = () => serveFolder(DIST, { change: withListener });

/** The text of the next file that the page saves, which a button of this name makes. */
async function saved(page, name) {
  await page.evaluate(() => {
    URL.createObjectURL = (blob) => {
      window.savedText = blob.text();
      return "#";
    };
    // WebKit would follow the link, and the page the new address.
    HTMLAnchorElement.prototype.click = () => {};
  });
  await page.evaluate((wanted) => {
    const isIt = (button) => (button.ariaLabel ?? button.textContent) === wanted;
    [...document.querySelectorAll("button")].find(isIt).click();
  }, name);
  return page.evaluate(() => window.savedText);
}

const state = (page) =>
  page.evaluate(() => ({ ...window.capsuleExplorer.state, views: [...window.capsuleExplorer.state.views] }));

function assertNative(shown, native) {
  for (const quantity of QUANTITIES) {
    assert.equal(Math.fround(shown[quantity]), Math.fround(native[quantity]), quantity);
  }
}

const boxOf = (page, selector) =>
  page.evaluate((wanted) => {
    const { x, y, width, height } = document.querySelector(wanted).getBoundingClientRect();
    return { x, y, width, height };
  }, selector);

for (const [name, browser] of Object.entries(BROWSERS)) {
  const lacking = missing(browser);
  const skip = lacking.length > 0 && `${lacking.join(" and ")} missing: ${browser.install}`;

  describe(name, { skip }, () => {
    let running;
    let server;
    let folder;
    let page;

    before(async () => {
      folder = mkdtempSync(join(tmpdir(), "capsule-"));
      mkdirSync(PICTURES, { recursive: true });
      server = await serve();
      running = await startDriven(browser);
      page = running.page;
      await page.resize(...WIDE);
    });
    after(async () => {
      await running?.stop();
      server?.stop();
      rmSync(folder, { recursive: true });
    });

    async function open(address, { url } = server) {
      await page.goto("about:blank");
      await page.goto(url + address);
      await page.waitForFunction(() => document.body.dataset.status !== "loading");
      await settled(page);
    }

    /** A test that drives the page at an address, and fails where it reports an error. */
    const onPage = (title, address, drive) =>
      test(title, async (context) => {
        await open(address);
        assert.equal(await page.getAttribute("body", "data-status"), "ready");
        await drive(context);
        assert.deepEqual(await page.evaluate(() => window.heardErrors), []);
      });

    test("says its version", async (context) => {
      assert.match(running.version, /\d/);
      context.diagnostic(`${running.version}, ${await page.evaluate(() => navigator.userAgent)}`);
    });

    for (const method of ["direct", "paper"]) {
      onPage(`has the native core's figures to the bit, by the method ${method}`, `#t=1${FLAT}`, async () => {
        const times = [0.4, 3, 6, 9];
        const native = predict(0.1, 0.9, times, method);
        assert.equal(await page.getAttribute("#model", "data-digest"), native.model_digest);
        await page.fill("#ca", 0.1);
        await page.fill("#confinement", 0.9);
        await page.click(`label:has(> input[name=method][value=${method}])`);
        for (const [i, t] of times.entries()) {
          await page.fill("#time-value", t);
          await settled(page);
          assertNative(await figures(page), native.instants[i]);
        }
      });
    }

    onPage("restores the state from the link that it wrote", `#ca=0.05&al=0.8&t=1${FLAT}`, async () => {
      await page.fill("#ca", 0.061);
      await page.fill("#time-value", 2.3);
      await page.click("label:has(> input[name=frame][value=centroid])");
      await page.click("[data-toggles=diagonal]");
      await page.click("#pin");
      await page.fill("#confinement", 0.83);
      await page.waitForFunction(() => /al=0\.83/.test(window.location.hash) && /pins=A/.test(window.location.hash));
      const wanted = await state(page);
      assert.deepEqual([wanted.ca, wanted.confinement, wanted.t, wanted.frame], [0.061, 0.83, 2.3, "centroid"]);
      const shown = await figures(page);
      await open(await page.evaluate(() => window.location.hash));
      assert.deepEqual(await state(page), wanted);
      assert.deepEqual(await figures(page), shown);
    });

    onPage("chooses on the map by a click and by dragging", `#ca=0.05&al=0.8&t=1${FLAT}`, async () => {
      const box = await boxOf(page, "#map-surface");
      const place = [box.x + 0.3 * box.width, box.y + 0.4 * box.height];
      await page.drag(place);
      await settled(page);
      const clicked = await state(page);
      const point = await boxOf(page, "#map-point");
      const middle = [point.x + point.width / 2, point.y + point.height / 2];
      assert.ok(Math.hypot(middle[0] - place[0], middle[1] - place[1]) < 3, `${place}, the point is at ${middle}`);
      assertNative(await figures(page), predict(clicked.ca, clicked.confinement, [1], "direct").instants[0]);
      await page.drag(middle, [middle[0] - 20, middle[1] + 30]);
      await settled(page);
      const dragged = await state(page);
      assert.ok(dragged.ca < clicked.ca && dragged.confinement < clicked.confinement, JSON.stringify(dragged));
    });

    onPage("is used by the keyboard alone", `#ca=0.05&al=0.8&t=1${FLAT}`, async () => {
      const focused = () => page.evaluate(() => document.activeElement.id);
      for (let press = 0; (await focused()) !== "map-point"; press++) {
        assert.ok(press < 30, "the Tab key reaches the map");
        await page.press("Tab");
      }
      for (const keys of ["ArrowRight", "ArrowUp", "Shift+ArrowRight"]) await page.press(keys);
      await settled(page);
      const { ca, confinement } = await state(page);
      assert.deepEqual([ca, confinement], [0.056, 0.81]);
      await page.press("Tab");
      assert.equal(await focused(), "ca");
      await page.evaluate(() => document.activeElement.blur());
      await page.press("ArrowRight");
      await page.press("Shift+ArrowRight");
      assert.equal((await state(page)).t, 2.1);
      await page.press("Space");
      await page.waitForFunction(() => window.capsuleExplorer.state.t > 2.3);
      await page.press("Space");
      const paused = await state(page);
      assert.equal(paused.playing, false);
      assertNative(await figures(page), predict(0.056, 0.81, [paused.t], "direct").instants[0]);
      await page.press("?");
      await page.waitForSelector("#help[open]");
      await page.press("Escape");
      await page.waitForFunction(() => !document.querySelector("#help").open);
    });

    onPage("refuses parameters outside with words and a way back", `#ca=0.9&al=0.9&t=1${FLAT}`, async () => {
      assert.equal(await page.getAttribute("body", "data-answer"), "refused");
      assert.match(await page.innerText("#notice"), /0\.9/);
      await page.click("#notice button:first-of-type");
      await settled(page);
      assert.equal(Object.keys(await figures(page)).length, QUANTITIES.length);
    });

    onPage("colours the capsule in space, or says that WebGL is missing", "#ca=0.1&al=0.9&t=3", async (context) => {
      await page.evaluate(() => window.capsuleExplorer.set({ colour: "stretch_1" }));
      await page.waitForFunction(() =>
        Boolean(document.querySelector("#solid").dataset.rendered ?? document.querySelector("#solid .missing")),
      );
      if (await page.evaluate(() => document.querySelector("#solid .missing") !== null)) {
        context.diagnostic("there is no WebGL");
        assert.match(await page.innerText("#solid .missing"), /WebGL/);
        return;
      }
      await page.waitForSelector("#field[data-most]");
      const ends = await page.evaluate(() => {
        const { least, most } = document.querySelector("#field").dataset;
        return [least, most].map(Number);
      });
      const { stretch_1: native } = predictFields(0.1, 0.9, 3, "direct");
      assert.deepEqual(ends.map(Math.fround), [Math.min(...native), Math.max(...native)]);
      const covered = await page.evaluate(() => {
        window.capsuleExplorer.set({ t: 3.1 });
        window.capsuleExplorer.read();
        const drawn = document.querySelector("#solid canvas");
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [drawn.width, drawn.height];
        const context = canvas.getContext("2d");
        context.drawImage(drawn, 0, 0);
        const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
        return data.filter((value, i) => i % 4 === 3 && value > 250).length;
      });
      assert.ok(covered > 5000, `${covered} pixels of the capsule`);
    });

    test("identifies a contour and a picture in a worker, with the command's numbers", async () => {
      const points = await section(0.06, 0.95);
      for (const [file, bytes, options] of [
        ["outline.csv", pointsText(points), undefined],
        ["capsule.png", picture(points), ["-o", "midplane", "--channel", "square"]],
      ]) {
        await open(`#ca=0.1&al=0.9&t=2&layer=misfit&views=midplane${SETUP}`);
        await drop(page, file, bytes);
        await identified(page);
        const path = join(folder, file);
        writeFileSync(path, bytes);
        assertSame(JSON.parse(await saved(page, "Answer, JSON")), identify(path, options));
        await page.waitForFunction(() => document.querySelectorAll("#map .contour").length >= 3);
        assert.deepEqual(await page.evaluate(() => window.heardErrors), []);
      }
    });

    onPage("plots, compares and exports the native core's numbers", "#ca=0.1&al=0.9&t=3&views=plots", async () => {
      await page.evaluate(() =>
        window.capsuleExplorer.set({
          pins: [{ name: "A", parameters: [0.05, 0.8], method: "paper", extrapolate: false }],
        }),
      );
      await page.waitForFunction(() => /times the error/.test(document.querySelector("#compare").textContent));
      await page.waitForFunction(() =>
        [...document.querySelectorAll(".plot .curve.live")].every((curve) => curve.getAttribute("d").length > 200),
      );
      await page.click("#open-take-away");
      await page.waitForSelector("#take-away[open]");
      const { traces } = JSON.parse(await saved(page, "Read-outs, now and along time, JSON"));
      assertNative(traces[0].instant, predict(0.1, 0.9, [3], "direct").instants[0]);
      assertNative(traces[1].instant, predict(0.05, 0.8, [3], "paper").instants[0]);
    });

    onPage("opens a model of other data from a file", `#t=1${FLAT}`, async () => {
      await page.setInputFiles("#model-file", otherModel());
      await page.waitForFunction(() => document.body.dataset.model === "other");
      await settled(page);
      assert.equal(Object.keys(await figures(page)).length, QUANTITIES.length);
    });

    test("works without a network after the first visit", async () => {
      const once = await serve();
      await open(`#ca=0.05&al=0.9&t=3${FLAT}`, once);
      const shown = await figures(page);
      await page.evaluate(() => navigator.serviceWorker.ready.then(() => true));
      once.stop();
      await open(`#ca=0.05&al=0.9&t=3${FLAT}`, once);
      assert.equal(await page.getAttribute("body", "data-status"), "ready");
      assert.deepEqual(await figures(page), shown);
    });

    for (const theme of ["light", "dark"]) {
      const choose = () =>
        page.evaluate((wanted) => {
          const choice = document.querySelector("#theme");
          choice.value = wanted;
          choice.dispatchEvent(new Event("change"));
        }, theme);
      const assertFits = async () => {
        const [content, room] = await page.evaluate(() => [document.documentElement.scrollWidth, window.innerWidth]);
        assert.ok(content <= room, `${content} px of content in ${room} px`);
      };

      onPage(`fits into ${WIDE.join(" x ")}, ${theme}`, "#ca=0.1&al=0.9&t=3", async () => {
        await choose();
        await settled(page);
        await assertFits();
        await page.screenshot(join(PICTURES, `${name}-wide-${theme}.png`));
      });

      onPage(`fits into ${NARROW.join(" x ")}, ${theme}`, "#ca=0.1&al=0.9&t=3", async () => {
        await choose();
        await page.enterFrame(...NARROW);
        await page.waitForFunction(() => document.body?.dataset.status === "ready");
        await settled(page);
        await assertFits();
        await page.screenshot(join(PICTURES, `${name}-narrow-${theme}.png`));
      });
    }
  });
}
