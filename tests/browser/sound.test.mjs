// The sound of the curve along time: its pitch is the core's value, and nothing sounds unasked.

import assert from "node:assert/strict";
import { test } from "node:test";
import { explorer, FLAT, predict, settled } from "./support.mjs";

const { open } = explorer();

/** Writes down what is asked of the browser's audio. */
function listen() {
  window.heard = { contexts: 0, curves: [], stops: 0 };
  const { setValueCurveAtTime } = AudioParam.prototype;
  AudioParam.prototype.setValueCurveAtTime = function (values, ...when) {
    window.heard.curves.push([...values]);
    return setValueCurveAtTime.call(this, values, ...when);
  };
  const { disconnect } = AudioNode.prototype;
  AudioNode.prototype.disconnect = function () {
    window.heard.stops++;
    disconnect.call(this);
  };
  window.AudioContext = class extends AudioContext {
    constructor() {
      super();
      window.heard.contexts++;
    }
  };
}

test("the pitch follows the value, from a key or a button, and stops by it", async () => {
  const { page, errors, close } = await open(`#ca=0.05&al=0.9&t=3&trace=velocity${FLAT}`, { before: listen });
  await page.waitForFunction(() => document.querySelector("#listen")?.disabled === false);
  await page.keyboard.press("ArrowRight");
  const heard = () => page.evaluate(() => window.heard);
  assert.deepEqual(await heard(), { contexts: 0, curves: [], stops: 0 }, "silent until it is asked for");
  await page.keyboard.press("l");
  const { curves } = await heard();
  assert.equal(await page.getAttribute("#listen", "aria-pressed"), "true");
  const [pitches, loudness] = curves;
  assert.equal(pitches.length, 101);
  assert.ok(loudness.every((gain) => gain >= 0 && gain <= 0.2));
  const times = [0, 1, 2, 10, 20];
  const values = predict(0.05, 0.9, times, "direct").instants.map(({ velocity }) => velocity);
  // Octaves above the lowest pitch are even steps of the value.
  const octaves = times.map((t) => Math.log2(pitches[5 * t] / pitches[0]));
  const scale = octaves[4] / (values[4] - values[0]);
  for (const [i, value] of values.entries()) {
    assert.ok(Math.abs(octaves[i] - scale * (value - values[0])) < 1e-4, `t = ${times[i]}: ${octaves[i]} octaves`);
  }
  assert.ok(Math.abs(Math.log2(Math.max(...pitches) / Math.min(...pitches)) - 2) < 1e-5);
  await page.click("#listen");
  assert.equal(await page.getAttribute("#listen", "aria-pressed"), "false");
  assert.equal((await heard()).stops, 1);
  // Another curve is another sound.
  await page.click("#listen");
  await page.click("#volume");
  await settled(page);
  assert.equal(await page.getAttribute("#listen", "aria-pressed"), "false");
  assert.match(await page.getAttribute("#listen", "aria-label"), /Volume/);
  assert.deepEqual(errors, []);
  await close();
});
