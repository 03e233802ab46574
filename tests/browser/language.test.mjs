// The page in French: no word of English is left in any view or state, it is as accessible and as narrow as the other
// one, and the choice of the language holds. Refusals of the core are in French by their codes.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { describe, test } from "node:test";
import { drop, HALF_WIDTH_UM, identified, pointsText, SETUP, section } from "./outlines.mjs";
import { explorer, FLAT, loaded, MODEL, openModel, ROOT, settled } from "./support.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const EXPLORER = resolve(import.meta.dirname, "../../wasm/explorer");
const VIEWS = "&views=midplane.diagonal.transversal.plots.measured";
const TOUR_STEPS = 6;

const { open, onPage } = explorer();
const language = (page) => page.getAttribute("html", "lang");

/** The messages of both languages from their sources, or what another source exports. */
async function messages(source) {
  const { createServer } = await import(resolve(EXPLORER, "node_modules/vite/dist/node/index.js"));
  const options = { root: EXPLORER, configFile: false, logLevel: "silent", appType: "custom" };
  const server = await createServer({ ...options, server: { middlewareMode: true, watch: null, hmr: false } });
  const paths = source === undefined ? ["/src/messages/en.ts", "/src/messages/fr.ts"] : [source];
  const modules = await Promise.all(paths.map((path) => server.ssrLoadModule(path)));
  await server.close();
  return Object.assign({}, ...modules);
}

/** Texts and functions of the messages, each with its path. */
function leaves(value, path = "") {
  if (typeof value !== "object") return [[path, value]];
  return Object.entries(value).flatMap(([key, one]) => leaves(one, `${path}.${key}`));
}

const plain = (text) => text.replace(/\s+/g, " ").trim();

/** All texts of the page, seen or not, and its names, hints and values in words; but for those of the core. */
async function textsOf(page) {
  const texts = await page.evaluate(() => {
    const isOwn = (element) =>
      element?.closest("script, style, noscript, dd[data-own], #model, #measured-file, #language, #help cite") ===
        null && element.closest('[lang="en"]:not(html, body)') === null;
    const found = [];
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) if (isOwn(walker.currentNode.parentElement)) found.push(walker.currentNode.data);
    for (const element of document.querySelectorAll("[aria-label], [title], [placeholder], [aria-valuetext], [alt]")) {
      if (!isOwn(element)) continue;
      for (const name of ["aria-label", "title", "placeholder", "aria-valuetext", "alt"]) {
        found.push(element.getAttribute(name) ?? "");
      }
    }
    return found;
  });
  return texts.map(plain).filter((text) => text !== "");
}

/** Brings the page in French into one state after another, and gathers its texts. */
async function walk(points) {
  const texts = new Set();
  const gather = async (page) => {
    await settled(page);
    for (const text of await textsOf(page)) texts.add(text);
  };
  const states = [
    `ca=0.13&al=0.95&t=3&extrapolate=1&along=ca&trace=error_bound${VIEWS}`,
    `ca=0.1&al=0.9&t=3&m=01234567&file=own.crom&dims=100,1,10&frame=centroid${FLAT}`,
    `ca=0.9&al=0.9${FLAT}`,
    `ca=0.15&al=1.1&t=20&extrapolate=1${FLAT}`,
    "ca=0.1&al=0.9&views=solid&colour=velocity&clip=y&pins=A:direct:0.1,0.9",
    "ca=0.06&al=0.95&t=3&views=midplane.measured",
  ];
  const first = `ca=0.08&al=0.9&t=3&pins=A:direct:0.1,0.9&layer=error_bound${VIEWS}`;
  const { page, close } = await open(`?lang=fr#${first}`, { viewport: { width: 720, height: 560 } });
  // The figures are spoken when they have been at rest.
  const said = () => page.waitForFunction(() => document.querySelector("#announcement").textContent !== "");
  await said();
  await gather(page);
  for (const state of states) {
    await page.evaluate((fragment) => {
      document.querySelector("#announcement").textContent = "";
      window.location.hash = fragment;
    }, state);
    await settled(page);
    if ((await page.getAttribute("body", "data-answer")) === "extrapolated") await said();
    if (state.includes("solid")) await page.waitForSelector("#field:not([hidden])");
    await gather(page);
  }
  await page.keyboard.press("Space");
  await gather(page);
  await page.keyboard.press("Space");
  for (const dialog of ["take-away", "units", "help"]) {
    await page.click(`#open-${dialog}`);
    await page.waitForSelector(`#${dialog}[open]`);
    await gather(page);
    await page.click(`#close-${dialog}`);
  }
  await page.fill("#time-value", "30");
  await gather(page);
  await page.click("#open-tour");
  for (let i = 0; i < TOUR_STEPS; i++) {
    await gather(page);
    await page.click("#tour-next");
  }
  await drop(page, "points.csv", pointsText(points));
  await gather(page);
  await page.evaluate((fragment) => {
    window.location.hash += fragment;
  }, `${SETUP}&layer=misfit`);
  await identified(page);
  await page.hover("#map-surface");
  await gather(page);
  await page.setInputFiles("#model-file", { name: "session.json", mimeType: "", buffer: Buffer.from("{}") });
  await page.waitForSelector("#failure:not([hidden])");
  await gather(page);
  await close();
  return texts;
}

/** Words that are the same in both languages, or names: no text of the page has others in common. */
const SHARED = new Set(
  (
    "CapsuleExplorer Capsule Explorer Confinement Volume Pause Oblique Tension pixels Figures CSV JSON HTML SVG PNG " +
    "STL OBJ VTP GLB MP4 live Licences Membrane own crom Entropy mPa mN pixels Extrapolation"
  ).split(" "),
);

describe("the page in French", () => {
  test("has no English text in any view or state", async () => {
    const french = [...(await walk(await section(0.06, 0.95)))];
    assert.ok(french.length > 250, `${french.length} texts`);
    const texts = leaves((await messages()).en).filter(([, value]) => typeof value === "string");
    const english = new Set(texts.flatMap(([, value]) => value.split(/<[^>]*>/)).map(plain));
    const words = (text) => (text.match(/\p{L}{3,}/gu) ?? []).filter((word) => !SHARED.has(word));
    assert.deepEqual(
      french.filter((text) => english.has(text) && words(text).length > 0),
      [],
    );
    // Of texts that are put together no part is left either.
    const small = /(?<!\p{L})(the|of|and|with|is|are|by|no|error|model|against|from)(?!\p{L})/iu;
    assert.deepEqual(
      french.filter((text) => small.test(text)),
      [],
    );
  });

  for (const [situation, options] of [
    ["desktop, light", { colorScheme: "light" }],
    ["phone, dark", { viewport: { width: 394, height: 800 }, colorScheme: "dark" }],
  ]) {
    test(`is accessible and not wider than the window: ${situation}`, async () => {
      const { page, close } = await open(
        `?lang=fr#ca=0.13&al=0.95&t=3&extrapolate=1&pins=A:direct:0.1,0.9${VIEWS}`,
        options,
      );
      await page.evaluate(AXE);
      for (const dialog of ["", "take-away", "units", "help"]) {
        if (dialog !== "") {
          await page.click(`#open-${dialog}`);
          await page.waitForSelector(`#${dialog}[open]`);
        }
        const part = dialog === "" ? "body" : `#${dialog}`;
        const { violations } = await page.evaluate((selector) => window.axe.run(selector), part);
        const found = violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(" | ")}`);
        assert.deepEqual(found, [], dialog);
        const over = await page.evaluate(() =>
          [...document.querySelectorAll("html, dialog[open], button, select, label, fieldset, .readout, figcaption")]
            .filter((part) => part.clientWidth > 0 && part.scrollWidth > part.clientWidth + 1)
            .map((part) => `${part.scrollWidth} > ${part.clientWidth}: ${part.outerHTML.slice(0, 200)}`),
        );
        assert.deepEqual(over, [], dialog);
        if (dialog !== "") await page.click(`#close-${dialog}`);
      }
      await close();
    });
  }
});

describe("the language", () => {
  test("is the link's, else the one chosen before, else the browser's", async () => {
    const inFrench = await open(`#ca=0.1${FLAT}`, { locale: "fr-CA" });
    assert.equal(await language(inFrench.page), "fr");
    await inFrench.page.goto(inFrench.page.url().replace("#", "?lang=en#"));
    await inFrench.page.waitForFunction(() => document.body.dataset.status === "ready");
    assert.equal(await language(inFrench.page), "en");
    await inFrench.close();
    const other = await open(`#ca=0.1${FLAT}`, { locale: "de-DE" });
    assert.equal(await language(other.page), "en");
    await other.close();
  });

  onPage("is chosen beside the theme, at once and for later", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const loaded = () =>
      page.evaluate(() => performance.getEntriesByType("resource").filter(({ name }) => /\/fr-/.test(name)).length);
    assert.equal(await loaded(), 0, "French is not loaded before it is asked for");
    await page.fill("#ca", "0.07");
    await page.keyboard.press("Tab");
    await page.click("#open-help");
    await page.selectOption("#language", "fr");
    await page.waitForFunction(() => document.documentElement.lang === "fr");
    await settled(page);
    assert.equal(await page.innerText("#query-title"), "Paramètres");
    assert.match(await page.innerText("#axial_length ~ .unit"), /ℓ/);
    assert.match(await page.getAttribute("#map-point", "aria-label"), /Nombre capillaire/);
    assert.match(await page.innerText("#track .caption"), /Longueur axiale, de 1\.\d+ à 1\.\d+/);
    assert.equal(await page.evaluate(() => window.capsuleExplorer.state.ca), 0.07, "what is shown stays");
    assert.equal(await loaded(), 1);
    await page.reload();
    await page.waitForFunction(() => document.body.dataset.status === "ready");
    assert.equal(await language(page), "fr");
  });

  onPage("is that of a refusal, with its values", `?lang=fr#ca=0.9&al=0.9${FLAT}`, async (page) => {
    const [, , least, most] = refusal(() => evaluation.prepare([0.9, 0.9], "direct", false)).values;
    const said = await page.innerText("#notice p");
    assert.equal(said, `Ca = 0.9 sort du domaine échantillonné, de ${least} à ${most}.`);
    assert.equal(await page.locator('#notice [lang="en"]').count(), 0);
    assert.match(await page.innerText("#notice button"), /point intérieur/);
  });

  onPage("of an element is its own", `?lang=en#ca=0.1${FLAT}`, async (page) => {
    await page.evaluate(() => {
      const element = '<capsule-explorer lang="fr" ca="0.05" al="0.8" views="midplane"></capsule-explorer>';
      document.body.insertAdjacentHTML("beforeend", element);
    });
    await page.waitForFunction(() => document.querySelector("capsule-explorer").dataset.status === "ready");
    const titles = () =>
      page.$$eval("#query-title, capsule-explorer [id$=query-title]", (parts) => parts.map((part) => part.innerText));
    assert.deepEqual(await titles(), ["Parameters", "Paramètres"]);
    await page.evaluate(() => document.querySelector("capsule-explorer").setAttribute("lang", "en"));
    await page.waitForFunction(() => document.querySelector("capsule-explorer .query h2").innerText === "Parameters");
    assert.equal(await language(page), "en");
  });
});

/** What a task of the module throws. */
function refusal(task) {
  try {
    task();
  } catch (error) {
    return error;
  }
  throw new Error(`${task} is not refused`);
}

/** The model file with some of its bytes changed. */
function changed(change) {
  const file = readFileSync(MODEL);
  return change(file) ?? file;
}

const model = await openModel();
const evaluation = model.evaluation();

/** Refusals of both modules: of queries, of model files, of outlines. */
async function refusals() {
  const { Model } = await loaded("capsule_wasm");
  const { Identifier } = await loaded("capsule_identify_wasm");
  const identifier = Identifier.open(readFileSync(MODEL));
  const ask = (parameters, t, task = () => evaluation.volume(), extrapolate = true) => {
    evaluation.prepare(parameters, "direct", extrapolate);
    evaluation.goTo(t);
    task();
  };
  const points = await section(0.06, 0.95);
  const said = { half_width_um: HALF_WIDTH_UM, velocity_mm_s: 5, viscosity_pa_s: 0.8, observable: "midplane" };
  const identify = (name, text, more) =>
    identifier.identify(name, Buffer.from(text), JSON.stringify({ ...said, ...more }));
  const text = pointsText(points);
  return [
    () => model.evaluation().volume(),
    () => ask([0.9, 0.9], 1, undefined, false),
    () => ask([0.13, 0.95], 1, undefined, false),
    () => ask([Number.NaN, 0.9], 1),
    () => ask([0.1], 1),
    () => ask([5, 0.9], 1),
    () => ask([0.1, 0.9], 1000),
    () => ask([0.15, 1.1], 20),
    () => ask([0.1, 0.9], 1, () => evaluation.outline("equator")),
    () => ask([0.1, 0.9], 1, () => evaluation.field("heat", "centroid")),
    () => ask([0.1, 0.9], 1, () => evaluation.silhouette(0, 2)),
    () => Model.open(Buffer.from("no model of a capsule")),
    () => Model.open(changed((file) => file.subarray(0, 5000))),
    () => Model.open(changed((file) => Buffer.concat([file, Buffer.alloc(3)]))),
    () => Model.open(changed((file) => void file.writeUInt32LE(77, 4))),
    () => Model.open(changed((file) => void file.writeUInt32LE(1, 4))),
    () => Model.open(changed((file) => void file.writeUInt8(file[5000] ^ 1, 5000))),
    () => identify("a.csv", "no points"),
    () => identify("a.csv", `${text}nine,4\n`),
    () => identify("a.csv", "1,2,3\n4,5,6\n", { unit: "um" }),
    () => identify("a.csv", text, { unit: "px" }),
    () => identify("a.csv", "1,2\n3,4\n"),
    () => identify("a.csv", "x_px,y_px\n1,2\n3,4\n"),
    () => identify("a.csv", "1,2\n3,4\n", { unit: "um" }),
    () => identify("a.csv", text, { half_width_um: 12 }),
    () => identify("a.csv", pointsText(points.with(5, points[60]).with(60, points[5]))),
    () => identify("a.csv", pointsText(points.slice(0, points.length / 2))),
    () => identify("a.csv", pointsText(points.map(([x]) => [x, 0]))),
    () => identify("a.png", "no picture"),
    () => identify("a.csv", text, { viscosity_pa_s: -1 }),
    () => identify("a.csv", text, { pixel_um: -1, unit: "px" }),
    () => identify("a.csv", text, { velocity_mm_s: null }),
    () => identify("a.csv", text, { viscosity: 1 }),
    () => identifier.misfit(Float64Array.of(0.1, 0.9)),
  ].map(refusal);
}

describe("the messages", () => {
  test("have every reason of the core", async () => {
    const codes = ["core/src/error.rs", "core/src/model/error.rs", "wasm/identify/src/refused.rs"].flatMap((path) => {
      const source = readFileSync(resolve(ROOT, path), "utf8");
      return [...source.matchAll(/=> \(\s*"([a-z-]+)",|=> "([a-z-]+)",/g)].map(([, code, name]) => code ?? name);
    });
    assert.ok(codes.length > 50, `${codes.length} codes`);
    const { fr } = await messages();
    assert.deepEqual(Object.keys(fr.refusals.core).sort(), [...new Set([...codes, "unknown-name"])].sort());
  });

  test("have the numbers of the core's words, in both languages", async () => {
    const { en, fr } = await messages();
    const { reason } = await messages("/src/model/refusal.ts");
    const numbers = (text) => (text.match(/\d[\d.e-]*\d|\d/g) ?? []).sort();
    const found = await refusals();
    for (const { code, values, message } of found) {
      assert.ok(code.length > 3 && message.length > 10, code);
      const refused = { code, values, words: message };
      assert.deepEqual(reason(en.refusals, refused), { words: message, isEnglish: true });
      const { words, isEnglish } = reason(fr.refusals, refused);
      assert.ok(!isEnglish && words !== message, code);
      assert.deepEqual(numbers(words), numbers(message), `${words}\n${message}`);
      assert.doesNotMatch(words, /undefined/);
    }
    assert.ok(new Set(found.map(({ code }) => code)).size > 24, found.map(({ code }) => code).join(" "));
  });

  test("are all used, and none is the same in both languages by mistake", async () => {
    const { en, fr } = await messages();
    const folder = resolve(EXPLORER, "src");
    const files = readdirSync(folder, { recursive: true }).filter((name) => /\.(ts|html)$/.test(name));
    const sources = files.filter((name) => !name.startsWith("messages/") && !name.startsWith("wasm/"));
    const text = sources.map((name) => readFileSync(resolve(folder, name), "utf8")).join("\n");
    // Groups that are indexed by a name of the state or of the core: their keys are checked by their types.
    const INDEXED = ["quantities", "laws"];
    const isUsed = (key) => new RegExp(`(\\.|[{,]\\s*|"|>)${key}\\b`).test(text);
    const unused = Object.entries(en)
      .filter(([group]) => !INDEXED.includes(group))
      .flatMap(([group, messages]) => Object.keys(messages).map((key) => [group, key]))
      .filter(([group, key]) => !isUsed(key) && !(group === "fields" && key in en.fields));
    assert.deepEqual(unused, []);
    const own = new Map(leaves(fr));
    const same = leaves(en).filter(([path, value]) => typeof value === "string" && own.get(path) === value);
    const names = same.map(([, value]) => value.replace(/<[^>]+>|[\d=×().,+−µ]/g, " ").trim());
    const shared = names.flatMap((name) => name.match(/\p{L}{3,}/gu) ?? []).filter((word) => !SHARED.has(word));
    assert.deepEqual(shared, []);
  });
});
