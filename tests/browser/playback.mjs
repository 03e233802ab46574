// Cost of a frame of the playback with all views: `npm run playback`, after `cargo xtask explore --build-only`.
// The time of the page's own thread: how fast a graphics card draws is not the page's. --profile names the functions.

import { openPage, serve, startBrowser } from "./support.mjs";

const VIEWS = "midplane.diagonal.transversal.plots.solid";
const FRAMES = 100;

/** Before the page's own program: counts the animation frames. */
function countFrames() {
  window.counted = 0;
  const ask = window.requestAnimationFrame;
  window.requestAnimationFrame = (callback) =>
    ask((time) => {
      window.counted++;
      callback(time);
    });
}

/** Milliseconds of the processor a frame, for scripts and for the layout that they ask for; and a profile. */
async function measure(browser, address) {
  const { page, close } = await openPage(browser, address, { before: countFrames });
  const session = await page.context().newCDPSession(page);
  const frames = (count) =>
    page.evaluate(async (wanted) => {
      window.counted = 0;
      while (window.counted < wanted) await new Promise((wake) => setTimeout(wake, 50));
      return window.counted;
    }, count);
  // Time of the thread: what else the machine does then does not count.
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  const spent = async () => {
    const { metrics } = await session.send("Performance.getMetrics");
    return Object.fromEntries(metrics.map(({ name, value }) => [name, 1e3 * value]));
  };
  await page.evaluate(() => window.capsuleExplorer.set({ t: 1, speed: 0.25, playing: true }));
  await frames(FRAMES);
  const before = await spent();
  const count = await frames(FRAMES);
  const after = await spent();
  await session.send("Profiler.enable");
  await session.send("Profiler.start");
  await frames(FRAMES);
  const { profile } = await session.send("Profiler.stop");
  await close();
  const each = (name) => (after[name] - before[name]) / count;
  return { script: each("ScriptDuration"), layout: each("LayoutDuration") + each("RecalcStyleDuration"), profile };
}

/** Functions by the samples that were taken in them. */
function shares({ nodes, samples }) {
  const names = new Map(nodes.map(({ id, callFrame }) => [id, callFrame.functionName || "(anonymous)"]));
  const counts = new Map();
  for (const sample of samples) counts.set(names.get(sample), (counts.get(names.get(sample)) ?? 0) + 1);
  return [...counts].sort((a, b) => b[1] - a[1]).map(([name, count]) => [name, count / samples.length]);
}

const server = await serve();
const browser = await startBrowser();
try {
  for (const [name, more] of [
    ["sections and plots", "&views=midplane.diagonal.transversal.plots"],
    ["all views", `&views=${VIEWS}`],
    ["all views, coloured", `&views=${VIEWS}&colour=tension_1`],
  ]) {
    const { script, layout, profile } = await measure(browser, `${server.url}#ca=0.1&al=0.9&t=1${more}`);
    process.stdout.write(`${name.padEnd(24)} scripts ${script.toFixed(2)} ms, layout ${layout.toFixed(2)} ms\n`);
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
