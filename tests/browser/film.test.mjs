// The film of the space view: a player opens it, and it shows the motion.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { explorer, openModel } from "./support.mjs";

const { open, onPage } = explorer();
/** A motion that is extrapolated and soon leads to a shape that is refused, where the film ends. */
const QUERY = [0.2, 0.95];
/** One surface: an emulated graphics card takes as long for each triangle, however small the picture is. */
const ADDRESS = "#ca=0.2&al=0.95&extrapolate=1&t=1&speed=5&views=solid&initial=0&colour=tension_1";
const VIEWPORT = { width: 400, height: 480 };

/** Frames of the film, 30 a second of 20 s at speed 5, whose shape the core gives. */
async function framesWithShape() {
  const model = await openModel();
  const evaluation = model.evaluation();
  evaluation.prepare(QUERY, "direct", true);
  for (let frame = 0; ; frame++) {
    evaluation.goTo((model.endTime * frame) / 120);
    try {
      evaluation.volume();
    } catch {
      return frame;
    }
  }
}

/** Runs in a page: the video's size and length, and how much of the picture differs between two of its instants. */
async function watch(data) {
  const video = document.createElement("video");
  video.muted = true;
  video.src = `data:video/mp4;base64,${data}`;
  const event = (name) => new Promise((wake) => video.addEventListener(name, wake, { once: true }));
  await event("loadeddata");
  const { videoWidth: width, videoHeight: height, duration } = video;
  const pixels = async (t) => {
    video.currentTime = t;
    await event("seeked");
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(video, 0, 0);
    return context.getImageData(0, 0, width, height).data;
  };
  const [first, last] = [await pixels(0.02), await pixels(duration - 0.05)];
  let changed = 0;
  for (let i = 0; i < first.length; i += 4) {
    if ([0, 1, 2].some((k) => Math.abs(first[i + k] - last[i + k]) > 40)) changed++;
  }
  return { width, height, duration, changed: changed / (width * height) };
}

onPage(
  "a film of the capsule lasts as long as it plays and has a shape, and moves",
  ADDRESS,
  async (page) => {
    await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
    await page.click("#open-take-away");
    const [download] = await Promise.all([
      page.waitForEvent("download", { timeout: 120_000 }),
      page.getByRole("button", { name: "Capsule in the channel, moving, MP4" }).click(),
    ]);
    assert.match(download.suggestedFilename(), /^capsule-motion-[0-9a-f]{8}\.mp4$/);
    assert.equal(await page.evaluate(() => window.capsuleExplorer.state.t), 1, "time is where it was");
    const player = await page.context().newPage();
    const film = await player.evaluate(watch, readFileSync(await download.path()).toString("base64"));
    const frames = await framesWithShape();
    assert.ok(frames > 10 && Math.abs(film.duration - frames / 30) < 0.02, `${frames} frames, ${film.duration} s`);
    const stage = await page.locator("#solid canvas").boundingBox();
    assert.ok(Math.abs(film.width - stage.width) <= 2 && film.height >= stage.height, JSON.stringify(film));
    assert.ok(film.changed > 0.02, `${film.changed} of the picture changes`);
  },
  { viewport: VIEWPORT },
);

test("a browser without WebCodecs says so, and loads nothing for films", async () => {
  const { page, close } = await open(ADDRESS, { viewport: VIEWPORT });
  const loaded = [];
  page.on("request", (request) => loaded.push(request.url()));
  await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
  await page.evaluate(() => delete window.VideoEncoder);
  await page.click("#open-take-away");
  await page.waitForSelector("#take-away[open]");
  assert.match(await page.innerText("#take-away-list"), /has no WebCodecs/);
  assert.ok(await page.getByRole("button", { name: "Capsule in the channel, moving, MP4" }).isDisabled());
  assert.ok(!loaded.some((address) => address.includes("video")), loaded.join());
  await close();
});
