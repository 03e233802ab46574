// What a frame of the playback with all views costs: `npm run playback`, after `cargo xtask explore --build-only`.
// The JavaScript of the frames alone: how fast a graphics card draws is not the page's.

import { openPage, serve, startBrowser } from "./support.mjs";

const VIEWS = "midplane.diagonal.transversal.plots.solid";
const FRAMES = 200;

/** Before the page's own program: times each animation frame's callbacks. */
function watchFrames() {
  window.spent = [];
  const ask = window.requestAnimationFrame;
  window.requestAnimationFrame = (callback) =>
    ask((time) => {
      const start = performance.now();
      callback(time);
      window.spent.push(performance.now() - start);
    });
}

/** Milliseconds a frame: median and 90th percentile, and the profile's share of each function. */
async function measure(browser, address) {
  const { page, close } = await openPage(browser, address, { before: watchFrames });
  await page.waitForTimeout(3000);
  const session = await page.context().newCDPSession(page);
  await session.send("Profiler.enable");
  await session.send("Profiler.setSamplingInterval", { interval: 200 });
  await session.send("Profiler.start");
  const spent = await page.evaluate(async (frames) => {
    window.capsuleExplorer.set({ t: 1, speed: 0.5, playing: true });
    window.spent = [];
    while (window.spent.length < frames) await new Promise((wake) => setTimeout(wake, 50));
    return window.spent.slice(5);
  }, FRAMES);
  const { profile } = await session.send("Profiler.stop");
  await close();
  return { spent: spent.sort((a, b) => a - b), profile };
}

/** Functions by the samples that were taken in them. */
function shares({ nodes, samples }) {
  const names = new Map(nodes.map(({ id, callFrame }) => [id, callFrame.functionName || "(anonymous)"]));
  const counts = new Map();
  for (const sample of samples) counts.set(names.get(sample), (counts.get(names.get(sample)) ?? 0) + 1);
  return [...counts].sort((a, b) => b[1] - a[1]).map(([name, count]) => [name, count / samples.length]);
}

const server = await serve();
const browser = await startBrowser(["--disable-gpu-rasterization"]);
try {
  for (const [name, more] of [
    ["sections and plots", "&views=midplane.diagonal.transversal.plots"],
    ["all views", `&views=${VIEWS}`],
    ["all views, coloured", `&views=${VIEWS}&colour=tension_1`],
  ]) {
    const { spent, profile } = await measure(browser, `${server.url}#ca=0.1&al=0.9&t=1${more}`);
    const at = (share) => spent[Math.floor(share * spent.length)].toFixed(2);
    process.stdout.write(`${name.padEnd(24)} median ${at(0.5)} ms, 90 % below ${at(0.9)} ms\n`);
    if (process.argv.includes("--profile")) {
      for (const [name, share] of shares(profile).slice(0, 25)) {
        process.stdout.write(`  ${(100 * share).toFixed(1).padStart(5)} %  ${name}\n`);
      }
    }
  }
} finally {
  await browser.close();
  server.stop();
}
