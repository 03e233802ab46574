// Both packages in plain pages in Chromium, from their archives and a static server, without a bundler.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { identify as byCommand, HALF_WIDTH_UM, pointsText, section } from "../../../tests/browser/outlines.mjs";
import { predict, startBrowser } from "../../../tests/browser/support.mjs";
import { examples, project, serve, textOf } from "./support.mjs";

const { folder, written } = project();
const TEXT = pointsText(await section(0.06, 0.95));
let browser;
let server;

before(async () => {
  [browser, server] = await Promise.all([startBrowser(), serve(folder)]);
});
after(async () => {
  await browser?.close();
  server?.stop();
});

/** Opens a page with this text, drives it, and fails if the console or the server reports an error. */
async function onPage(html, drive) {
  written("page.html", html);
  const page = await browser.newPage();
  page.setDefaultTimeout(120_000);
  const errors = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  const requests = [];
  page.on("request", (request) => requests.push(request.url()));
  page.on("response", (response) => response.status() >= 400 && errors.push(`${response.status()} ${response.url()}`));
  try {
    await page.goto(`${server.url}page.html`, { waitUntil: "commit" });
    await drive(page, requests);
    assert.deepEqual(errors, []);
  } finally {
    await page.close();
  }
}

const ready = (page) => page.waitForSelector('capsule-explorer[data-status="ready"]');

/** What a page asked for beyond itself and a package. */
function foreign(requests, name) {
  const own = `${server.url}node_modules/${name}/dist/`;
  return requests.filter((url) => !url.startsWith(own) && !/(page.html|favicon.ico)$/.test(url));
}

describe("capsule-rom", () => {
  test("predicts in the page of its guides, and asks for nothing but itself", () => {
    const [html] = examples("wasm/npm/capsule-rom/README.md", "html");
    assert.equal(html, examples("docs/guides/javascript.md", "html")[0]);
    return onPage(html, async (page, requests) => {
      await page.waitForFunction(() => document.querySelector("output").textContent !== "");
      const [{ axial_length }] = predict(0.1, 0.9, [3], "direct").instants;
      assert.equal(await page.textContent("output"), `${Math.fround(axial_length)} l`);
      assert.deepEqual(foreign(requests, "capsule-rom"), []);
      assert.ok(!requests.some((url) => url.includes("identify")), "the identification is loaded on demand");
    });
  });

  test("identifies in a page, with the numbers of the command", () =>
    onPage("<title>A page</title>", async (page) => {
      const { answer } = await page.evaluate(
        async ([text, half_width_um]) => {
          const [{ load }, { identify }] = await Promise.all(
            ["index", "identify"].map((name) => import(`/node_modules/capsule-rom/dist/${name}.js`)),
          );
          const setup = { half_width_um, velocity_mm_s: 5, viscosity_pa_s: 0.8, observable: "midplane" };
          return identify(await load(), text, setup);
        },
        [TEXT, HALF_WIDTH_UM],
      );
      assert.deepEqual(answer, byCommand(written("outline.csv", TEXT)));
    }));

  test("names what cannot be opened", () =>
    onPage("<title>A page</title>", async (page) => {
      const [code, message] = await page.evaluate(async () => {
        const { load } = await import("/node_modules/capsule-rom/dist/index.js");
        return load("data:,this is no model of a capsule").catch(({ code, message }) => [code, message]);
      });
      assert.equal(code, "magic");
      assert.match(message, /not a model file: it starts with/);
    }));
});

describe("capsule-explorer", () => {
  test("shows the page of the book, with the numbers of the command, and asks for nothing but itself", () =>
    onPage(examples("docs/guides/javascript.md", "html")[1], async (page, requests) => {
      await ready(page);
      const [expected] = predict(0.05, 0.8, [6], "direct").instants;
      const found = await page.$eval("capsule-explorer", (element) => element.read());
      assert.equal(found.axial_length, Math.fround(expected.axial_length));
      assert.equal(found.error_bound, Math.fround(expected.error_bound));
      const notices = await page.$eval("capsule-explorer a[href$='THIRD-PARTY.txt']", async ({ href }) => {
        const answer = await fetch(href);
        return [answer.ok, await answer.text()];
      });
      assert.ok(notices[0] && notices[1].includes("wasm-bindgen"), "the notices are beside the script");
      assert.deepEqual(foreign(requests, "capsule-explorer"), []);
      assert.deepEqual(await page.$$eval("body > *", (all) => all.map(({ localName }) => localName)), [
        "capsule-explorer",
      ]);
    }));

  test("has the attributes, the event and the methods that its guide names", () =>
    onPage(examples("wasm/npm/capsule-explorer/README.md", "html")[0], async (page) => {
      await ready(page);
      const attributes = await page.evaluate(() => customElements.get("capsule-explorer").observedAttributes);
      const heard = await page.$eval("capsule-explorer", async (explorer) => {
        const told = [];
        explorer.addEventListener("statechange", () => told.push([explorer.state.ca, explorer.state.t]));
        explorer.setAttribute("ca", "0.06");
        explorer.set({ t: 7 });
        let refusal;
        try {
          explorer.set({ t: "late" });
        } catch (error) {
          refusal = error.name;
        }
        return { told, refusal };
      });
      assert.deepEqual(heard, {
        told: [
          [0.06, 6],
          [0.06, 7],
        ],
        refusal: "TypeError",
      });
      assert.deepEqual([...documented()].sort(), [...attributes, "model"].sort());
    }));

  test("identifies and shows space, two on a page, beside the core's own package", () =>
    onPage(
      `<title>Both</title>
       <script type="module" src="./node_modules/capsule-explorer/dist/capsule-explorer.js"></script>
       <capsule-explorer id="first" views="solid" controls="none" style="width: 9rem; height: 9rem"></capsule-explorer>
       <capsule-explorer id="second" ca="0.05" views="measured" half="25" vel="5" visc="0.8"></capsule-explorer>
       <output id="answer"></output>
       <script type="module">
         import { load } from "./node_modules/capsule-rom/dist/index.js";
         const model = await load();
         document.querySelector("#answer").value = model.predict(0.05, 0.9).observables(2).axial_length;
       </script>`,
      async (page, requests) => {
        await page.waitForFunction(() => document.querySelectorAll('[data-status="ready"]').length === 2);
        await page.waitForFunction(() => document.querySelector("#answer").value !== "");
        const second = await page.$eval("#second", (element) => element.read());
        assert.equal(String(second.axial_length), await page.$eval("#answer", ({ value }) => value));
        await page.waitForSelector("#first canvas", { state: "attached" });
        await page.locator("#second input[type=file]").first().setInputFiles(written("outline.csv", TEXT));
        await page.waitForSelector("#second output[data-identified]");
        assert.ok(requests.some((url) => /capsule-explorer.dist.assets.capsule_identify/.test(url)));
      },
    ));
});

/** The attributes in the table of the element's guide. */
function documented() {
  const [, table] = textOf("wasm/npm/capsule-explorer/README.md").match(/^## Attributes\n(.*?)^## /ms);
  const cells = [...table.matchAll(/^\| (`.*?) \|/gm)].map(([, cell]) => cell);
  return cells.flatMap((cell) => [...cell.matchAll(/`(\w+)`/g)].map(([, name]) => name));
}
