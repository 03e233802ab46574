// Lighthouse's scores of the page, medians: `npm run lighthouse`, after `cargo xtask explore --build-only`. npm brings
// the program for the time of the command. With `--write` the scores go into docs/results/lighthouse.json.

import { execFile } from "node:child_process";
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { promisify } from "node:util";
import { serveFolder } from "./static-server.mjs";
import { CHROMIUM, DIST, ROOT } from "./support.mjs";

const RUNS = 5;
const CATEGORIES = ["performance", "accessibility", "best-practices", "seo"];
/** What Lighthouse measures in ms, by the names that the result has. */
const TIMES = {
  first_contentful_paint_ms: "first-contentful-paint",
  largest_contentful_paint_ms: "largest-contentful-paint",
  total_blocking_time_ms: "total-blocking-time",
};
const PROFILES = { mobile: [], desktop: ["--preset=desktop"] };

/** Asynchronous, since the server is in this process. */
const run = promisify(execFile);

async function audit(url, options) {
  const flags = ["--quiet", "--output=json", "--chrome-flags=--headless=new --no-sandbox", ...options];
  const { stdout } = await run("lighthouse", [url, ...flags], {
    env: { ...process.env, CHROME_PATH: CHROMIUM },
    maxBuffer: 2 ** 26,
  });
  return JSON.parse(stdout);
}

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const medianOf = (reports, value) => median(reports.map(value));

/** Audits that take from a score in most of the runs, with what they found. */
function faults(reports) {
  const [{ categories, audits }] = reports;
  const refs = CATEGORIES.flatMap((category) => categories[category].auditRefs.filter(({ weight }) => weight > 0));
  return refs.flatMap(({ id }) => {
    const score = medianOf(reports, (report) => report.audits[id].score ?? 1);
    const { title, displayValue = "" } = audits[id];
    return score < 0.9 ? [`${score.toFixed(2)} ${title} ${displayValue}`.trim()] : [];
  });
}

const server = await serveFolder(DIST, { isCompressed: true });
const results = { runs: RUNS, profiles: [] };
try {
  for (const [profile, options] of Object.entries(PROFILES)) {
    const reports = [];
    while (reports.length < RUNS) reports.push(await audit(server.url, options));
    const [{ lighthouseVersion, environment }] = reports;
    results.lighthouse = lighthouseVersion;
    results.chromium = /Chrome\/(\d+)/.exec(environment.hostUserAgent)[1];
    const scores = CATEGORIES.map((id) => [
      id.replace("-", "_"),
      medianOf(reports, ({ categories }) => categories[id].score),
    ]);
    const times = Object.entries(TIMES).map(([name, id]) => [
      name,
      Math.round(medianOf(reports, ({ audits }) => audits[id].numericValue)),
    ]);
    const shift = medianOf(reports, ({ audits }) => audits["cumulative-layout-shift"].numericValue);
    const found = Object.fromEntries([...scores, ...times, ["layout_shift", Number(shift.toFixed(3))]]);
    results.profiles.push({ profile, ...found });
    process.stdout.write(`${profile}\n`);
    for (const [name, value] of Object.entries(found)) process.stdout.write(`  ${name.padEnd(28)} ${value}\n`);
    for (const fault of faults(reports)) process.stdout.write(`  below: ${fault}\n`);
  }
} finally {
  server.stop();
}
if (process.argv.includes("--write")) {
  writeFileSync(resolve(ROOT, "docs/results/lighthouse.json"), `${JSON.stringify(results, null, 2)}\n`);
}
