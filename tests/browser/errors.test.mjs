// How CapsuleExplorer states an answer's validity: the reference of its errors, extrapolation, and refusal.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { explorer, FLAT, figures, membraneChanged, openModel, predict, QUANTITIES, settled } from "./support.mjs";

const INSIDE = { ca: 0.1, confinement: 0.9, t: 3 };
/** Just beyond the largest steady Ca, where the shape is still one that a capsule can have. */
const EXTRAPOLATED = { ca: 0.13, confinement: 0.95, t: 3 };
/** Far beyond it; late in the motion no capsule has the shape. */
const REFUSED = { ca: 0.15, confinement: 1.1, t: 20 };
const UNREFUSED = 0.5;

const { open, onPage } = explorer();

const link = ({ ca, confinement, t }, more = "") => `#ca=${ca}&al=${confinement}&t=${t}${more}`;
const answer = (page) => page.getAttribute("body", "data-answer");
const set = async (page, patch) => {
  await page.evaluate((wanted) => window.capsuleExplorer.set(wanted), patch);
  await settled(page);
};

/** Waits for the announcement to screen readers, which comes when the state has come to rest. */
async function announced(page) {
  await page.waitForFunction(() => document.querySelector("#announcement").textContent !== "");
  return words(page, "#announcement");
}

/** Text on screen, with plain spaces. */
const words = async (page, selector) => (await page.innerText(selector)).replaceAll("\u00a0", " ");

/** A read-out's row. */
const rowOf = (page, quantity) => page.locator(`.readout:has(#${quantity})`);

/** Nothing is drawn and nothing is read out. */
async function assertNothing(page) {
  assert.equal(await answer(page), "refused");
  assert.deepEqual(await figures(page), {});
  const drawn = page.locator(".figures :is(.membrane, .initial):not([d=''])");
  assert.equal(await drawn.count(), 0);
  assert.match(await page.getAttribute("#figures", "aria-label"), /no shape/);
  assert.equal(await page.isVisible("#extrapolated"), false);
  // Longer than the delay of the announcement.
  await page.waitForTimeout(900);
  assert.equal(await page.textContent("#announcement"), "");
}

/** Pixels of the space view that something solid covers, in the task that draws them. */
function solidPixels(page, patch) {
  return page.evaluate((wanted) => {
    window.capsuleExplorer.set(wanted);
    window.capsuleExplorer.read();
    const picture = document.querySelector("#solid canvas");
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, i) => i % 4 === 3 && value > 250).length;
  }, patch);
}

/** A query whose shape is refused at t = 0 but not a little later. */
async function startsRefused() {
  const evaluation = (await openModel()).evaluation();
  for (let ca = 0.1; ca < 0.2; ca += 0.005) {
    for (let confinement = 1; confinement < 1.4; confinement += 0.05) {
      const [query, t] = [[ca, confinement].map((value) => Number(value.toFixed(3))), 0.2];
      const isAnswered = (instant) => {
        try {
          evaluation.goTo(instant);
          return evaluation.volume() > 0;
        } catch {
          return false;
        }
      };
      try {
        evaluation.prepare(query, "direct", true);
      } catch {
        continue;
      }
      if (!isAnswered(0) && isAnswered(t)) return { ca: query[0], confinement: query[1], t };
    }
  }
  throw new Error("every query that is answered at t = 0.2 is answered at t = 0 too");
}

describe("an answer inside the sampled domain", () => {
  onPage("says what its errors are taken against", `${link(INSIDE)}${FLAT}`, async (page) => {
    const native = predict(0.1, 0.9, [3], "direct");
    const against = `against ${native.errors_against.replace(" G_s a^2", "")}`;
    assert.match(against, /neo-Hookean, B = \d/);
    const said = await words(page, "#errors");
    assert.ok(said.includes(against), said);
    assert.match(said, /modified Hausdorff distance/);
    assert.ok((await announced(page)).endsWith(`errors ${against}`));
    for (const quantity of ["expected_error", "error_bound"]) {
      assert.equal(await rowOf(page, quantity).getAttribute("aria-describedby"), "errors");
      await set(page, { trace: quantity });
      const caption = await words(page, "#track .caption");
      assert.ok(caption.includes(against), caption);
    }
    await set(page, { trace: "volume" });
    assert.ok(!(await page.innerText("#track .caption")).includes("against"));
  });

  onPage("takes the law and the bending stiffness from the model", FLAT.replace("&", "#"), async (page) => {
    const buffer = membraneChanged("some-law-01", 2.5e-3);
    await page.setInputFiles("#model-file", { name: "own.crom", mimeType: "application/octet-stream", buffer });
    await page.waitForFunction(() => document.querySelector("#model").textContent.includes("some-law-01"));
    assert.match(await words(page, "#errors"), /against the full-order model \(some-law-01, B = 2\.5e-3\):/);
  });

  onPage("has a bound and is not marked", `${link(INSIDE)}${FLAT}`, async (page) => {
    assert.equal(await answer(page), "given");
    assert.equal(await page.isVisible("#extrapolated"), false);
    const [instant] = predict(0.1, 0.9, [3], "direct").instants;
    assert.equal(Math.fround((await figures(page)).error_bound), Math.fround(instant.error_bound));
    assert.doesNotMatch(await page.innerText("#readouts"), /guess|none/);
    assert.doesNotMatch(await announced(page), /xtrapolated|guess|none/);
  });
});

describe("an extrapolated answer", () => {
  onPage("is marked, its error is a guess and it has no bound", `${link(EXTRAPOLATED)}${FLAT}`, async (page) => {
    assert.equal(await answer(page), "refused");
    await page.click("#notice button:last-of-type");
    await settled(page);
    assert.equal(await answer(page), "extrapolated");
    assert.equal(await page.innerText("#extrapolated"), "Extrapolated");
    assert.match(await page.innerText("#notice"), /beyond the largest steady Ca/);

    const native = predict(EXTRAPOLATED.ca, EXTRAPOLATED.confinement, [EXTRAPOLATED.t], "direct", true);
    assert.equal(native.domain, "beyond-steady-limit");
    const [instant] = native.instants;
    const shown = await figures(page);
    for (const quantity of QUANTITIES) {
      const expected = instant[quantity] === null ? undefined : Math.fround(instant[quantity]);
      assert.equal(shown[quantity] && Math.fround(shown[quantity]), expected, quantity);
    }
    assert.equal(shown.error_bound, undefined);
    assert.match(await rowOf(page, "expected_error").innerText(), /a guess/);
    assert.match(await rowOf(page, "error_bound").innerText(), /none/);
    assert.doesNotMatch(await rowOf(page, "error_bound").innerText(), /% a/);
    assert.match(await page.getAttribute("#readouts", "aria-label"), /^Extrapolated/);
    const announcement = await announced(page);
    assert.match(announcement, /^Extrapolated.*Expected error, a guess [\d.]+ % a, /);
    assert.match(announcement, /95 % error bound none; errors against/);

    await set(page, { trace: "error_bound" });
    await page.waitForFunction(() => document.querySelector("#track .caption").textContent.endsWith(": none"));
    assert.equal(await page.getAttribute("#track .trace", "d"), "");
    await set(page, { trace: "axial_length" });
    await page.waitForFunction(() => document.querySelector("#track .trace").getAttribute("d") !== "");
    assert.match(await page.innerText("#track .caption"), /^Extrapolated: Axial length/);
  });

  onPage("is not marked once it is inside", link(EXTRAPOLATED, `&extrapolate=1${FLAT}`), async (page) => {
    assert.equal(await answer(page), "extrapolated");
    await page.click("#notice button");
    await settled(page);
    assert.equal(await answer(page), "given");
    assert.equal(await page.isVisible("#extrapolated"), false);
    assert.doesNotMatch(await page.innerText("#readouts"), /guess|none/);
    assert.doesNotMatch(await page.getAttribute("#readouts", "aria-label"), /Extrapolated/);
  });
});

describe("a shape that no capsule can have", () => {
  const before = { ...REFUSED, t: UNREFUSED };
  onPage("is refused with the core's words", link(before, `&extrapolate=1${FLAT}`), async (page) => {
    assert.equal(await answer(page), "extrapolated");
    await announced(page);
    await set(page, { t: REFUSED.t });
    await assertNothing(page);
    assert.match(await page.innerText("#notice"), /No answer at t = 20: no capsule has the extrapolated shape: /);
    assert.throws(
      () => predict(REFUSED.ca, REFUSED.confinement, [REFUSED.t], "direct", true),
      /no capsule has the extrapolated shape/,
    );
    assert.equal(await page.locator("#notice button").count(), 1, "it is extrapolated already");

    // The instants that do have an answer keep theirs.
    await page.waitForFunction(() => document.querySelector("#track .trace").getAttribute("d") !== "");
    await set(page, { t: UNREFUSED });
    assert.equal(await answer(page), "extrapolated");
    assert.ok((await page.getAttribute("#midplane .membrane", "d")).length > 100);
    await set(page, { t: REFUSED.t });
    await page.click("#notice button");
    await settled(page);
    assert.equal(await answer(page), "given");
  });

  test("at t = 0 does not take the answer from a later instant", async () => {
    const query = await startsRefused();
    const { page, close } = await open(link(query, `&extrapolate=1${FLAT}`));
    assert.equal(await answer(page), "extrapolated");
    assert.ok((await page.getAttribute("#midplane .membrane", "d")).length > 100);
    assert.equal(await page.getAttribute("#midplane .initial", "d"), "");
    await set(page, { t: 0 });
    await assertNothing(page);
    await close();
  });

  onPage("has no error either", link(before, `&extrapolate=1&trace=expected_error${FLAT}`), async (page) => {
    await page.waitForFunction(() => / % a$/.test(document.querySelector("#track .caption").textContent));
    const right = (selector) => page.locator(selector).evaluate((one) => one.getBoundingClientRect().right);
    assert.ok((await right("#track .trace")) < (await right("#track")) - 20, "the curve ends before the last instant");
  });

  onPage("stops the time that runs into it", link(before, `&extrapolate=1&speed=5${FLAT}`), async (page) => {
    await page.keyboard.press("Space");
    await page.waitForFunction(() => document.body.dataset.answer === "refused");
    await settled(page);
    const { playing, t } = await page.evaluate(() => window.capsuleExplorer.state);
    assert.equal(playing, false);
    assert.ok(UNREFUSED < t && t < REFUSED.t);
    assert.match(await page.innerText("#notice"), /No answer at t = \d/);
  });

  onPage(
    "leaves the space view empty",
    link(before, "&extrapolate=1&views=solid"),
    async (page) => {
      await page.waitForSelector("#solid[data-rendered]");
      const answered = await solidPixels(page, { t: UNREFUSED / 2 });
      assert.ok(answered > 5000, `${answered} pixels of the capsule`);
      const refused = await solidPixels(page, { t: REFUSED.t });
      assert.ok(refused < answered / 20, `${refused} pixels where there is no capsule`);
      assert.ok((await solidPixels(page, { t: UNREFUSED })) > 5000);
    },
    { viewport: { width: 720, height: 560 } },
  );
});

describe("a refused query", () => {
  onPage("leaves nothing of the one before", `${link(INSIDE)}${FLAT}`, async (page) => {
    await announced(page);
    await page.waitForFunction(() => document.querySelector("#track .trace").getAttribute("d") !== "");
    await set(page, { ca: 0.9 });
    await assertNothing(page);
    assert.equal(await page.getAttribute("#track .trace", "d"), "");
    assert.equal(await page.textContent("#track .caption"), "");
    assert.equal(await page.getAttribute("#track .now", "r"), "0.00");
    // Nor after a new layout.
    await page.setViewportSize({ width: 1300, height: 850 });
    await settled(page);
    assert.equal(await page.getAttribute("#midplane .membrane", "d"), "");
  });

  onPage("gives scripts no figures before the next frame", `${link(INSIDE)}${FLAT}`, async (page) => {
    const read = (patch) =>
      page.evaluate((wanted) => {
        window.capsuleExplorer.set(wanted);
        return window.capsuleExplorer.read();
      }, patch);
    const { method: _, ...rest } = await read({ ca: 0.9 });
    assert.deepEqual(rest, { ca: 0.9, confinement: 0.9, t: 3, answer: "refused" });
    const [instant] = predict(0.08, 0.9, [3], "direct").instants;
    const found = await read({ ca: 0.08 });
    assert.equal(found.answer, "given");
    assert.equal(Math.fround(found.axial_length), Math.fround(instant.axial_length));
  });
});
