// CapsuleExplorer as an instrument: what it compares, maps, plots and gives away has the native core's numbers, and
// every file that it saves is opened again.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { describe, test } from "node:test";
import { explorer, FLAT, figures, predict, QUANTITIES, settled } from "./support.mjs";

const { open, onPage, url } = explorer();

const state = (page) => page.evaluate(() => window.capsuleExplorer.state);
const native = (ca, confinement, t, method = "direct") => predict(ca, confinement, [t], method).instants[0];

/** Presses a button of the export dialog and returns the file. */
async function save(page, name) {
  if (!(await page.isVisible("#take-away"))) await page.click("#open-take-away");
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name, exact: true }).click(),
  ]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

/** Volume within a closed surface: a sixth of the sum of its corners' determinants. */
function volumeOf(points, corners) {
  let six = 0;
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => points.slice(3 * corners[i + k], 3 * corners[i + k] + 3));
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}

describe("a comparison", () => {
  onPage(
    "shows pinned queries beside the live one, with their differences",
    `#ca=0.1&al=0.9&t=3${FLAT}`,
    async (page) => {
      await page.click("#pin");
      await page.fill("#ca", "0.05");
      await page.waitForFunction(() => /times the error/.test(document.querySelector("#compare").textContent));
      const rows = await page.$$eval("#compare tbody tr", (all) => all.map((row) => row.innerText.split("\t")));
      const [live, pinned] = [native(0.05, 0.9, 3), native(0.1, 0.9, 3)];
      const [name, own, other] = rows[0];
      assert.match(name, /Axial length/);
      assert.equal(own, live.axial_length.toFixed(4));
      assert.ok(other.startsWith(pinned.axial_length.toFixed(4)));
      const difference = Number(other.split(/\s/)[1].replace("−", "-"));
      assert.ok(Math.abs(difference - (live.axial_length - pinned.axial_length)) < 6e-5);
      assert.equal(await page.locator("#midplane .pin-A").count(), 1);
      assert.equal(await page.locator("#map .pin-A").count(), 1);
      await page.waitForFunction(() => window.location.hash.includes("pins=A"));
      const again = await open(page.url().slice(url().length));
      assert.deepEqual((await state(again.page)).pins, (await state(page)).pins);
      await again.close();
      await page.getByRole("button", { name: "Remove A" }).click();
      await settled(page);
      assert.equal(await page.isVisible("#compare"), false);
    },
  );

  onPage("forgets a query that is unpinned before it was compared", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    await page.evaluate(() => {
      const pins = [{ name: "A", parameters: [0.05, 0.8], method: "direct", extrapolate: false }];
      window.capsuleExplorer.set({ pins });
      window.capsuleExplorer.read();
      window.capsuleExplorer.set({ pins: [] });
      window.capsuleExplorer.read();
    });
    await page.waitForTimeout(400);
    assert.equal(await page.isVisible("#compare"), false);
  });

  onPage(
    "says where two shapes are the same or not resolved",
    `#ca=0.1&al=0.9&t=3&pins=A:direct:0.1,0.9;B:direct:0.10001,0.9${FLAT}`,
    async (page) => {
      await page.waitForFunction(() => /not resolved/.test(document.querySelector("#compare").textContent));
      assert.match(await page.innerText("#compare"), /the same shape/);
    },
  );

  onPage(
    "measures the modified Hausdorff distance of the nodes",
    `#ca=0.08&al=0.9&t=3&pins=A:direct:0.1,0.9${FLAT}`,
    async (page) => {
      await page.waitForFunction(() => /times the error/.test(document.querySelector("#compare").textContent));
      const shown = Number(/([\d.]+) % a/.exec(await page.innerText("#compare .distance"))[1]) / 100;
      // The distance along the axis alone bounds it from above: the nodes move by the drift and the deformation.
      assert.ok(shown > 0.001 && shown < 0.1, `distance ${shown} a`);
    },
  );
});

describe("an uncertain answer", () => {
  onPage("looks so in numbers and drawings, a certain one does not", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const look = async () => [
      await page.isVisible("#uncertain"),
      (await page.innerText("#axial_length")).startsWith("≈"),
      await page.locator("#midplane .membrane.uncertain").count(),
    ];
    assert.deepEqual(await look(), [false, false, 0]);
    await page.evaluate(() => window.capsuleExplorer.set({ ca: 0.13, confinement: 0.95, extrapolate: true }));
    await settled(page);
    const [, isRough, broken] = await look();
    assert.deepEqual([isRough, broken], [true, 1]);
    const wide = await page.$eval("#midplane .band", (band) => Number(band.getAttribute("stroke-width")));
    assert.ok(wide > 5, `the band is ${wide} px wide`);
  });
});

describe("the map", () => {
  onPage(
    "draws contours of any read-out, on three scales",
    `#ca=0.1&al=0.9&t=20&layer=axial_length${FLAT}`,
    async (page) => {
      await page.waitForFunction(() => document.querySelectorAll("#map .contour").length > 2);
      const levels = await page.$$eval("#map .level", (labels) => labels.map((label) => Number(label.textContent)));
      assert.ok(levels.length > 1 && levels.every((level) => level > 1 && level < 5), levels.join());
      assert.match(await page.innerText("#map-legend"), /Axial length at t = 20/);
      for (const scale of ["root", "log", "linear"]) {
        await page.selectOption("#scale", scale);
        await settled(page);
        const point = await page.locator("#map-point").boundingBox();
        await page.mouse.click(point.x + point.width / 2, point.y + point.height / 2);
        await settled(page);
        const { ca, confinement } = await state(page);
        assert.ok(Math.abs(ca - 0.1) < 0.002 && Math.abs(confinement - 0.9) < 0.006, `${scale}: ${ca}, ${confinement}`);
        await page.evaluate(() => window.capsuleExplorer.set({ ca: 0.1, confinement: 0.9 }));
        await settled(page);
      }
      await page.selectOption("#layer", "error_bound");
      await page.waitForFunction(() =>
        /against the full-order model/.test(document.querySelector("#map-legend").textContent),
      );
      await page.uncheck("#samples");
      await settled(page);
      assert.equal(await page.locator("#map .sample").count(), 0);
    },
  );
});

describe("the mouse over the map", () => {
  onPage("previews the chosen read-out of what a click would give", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const box = await page.locator("#map-surface").boundingBox();
    // A click has whole pixels.
    const place = [box.x + 0.35 * box.width, box.y + 0.5 * box.height].map(Math.round);
    await page.mouse.move(...place);
    const hint = await page.textContent("#map .hint");
    assert.equal((await state(page)).ca, 0.1);
    await page.mouse.click(...place);
    await settled(page);
    const { ca, confinement } = await state(page);
    const { axial_length } = native(ca, confinement, 3);
    assert.equal(hint, `Ca ${ca}, a/ℓ ${confinement}: ${axial_length.toFixed(4)} ℓ`);
  });
});

describe("the plots", () => {
  onPage("show all read-outs along time and along the parameters", "#ca=0.05&al=0.9&t=3&views=plots", async (page) => {
    const drawn = () =>
      page.waitForFunction(() =>
        [...document.querySelectorAll(".plot .curve.live")].every((curve) => curve.getAttribute("d").length > 200),
      );
    await drawn();
    assert.equal(await page.locator(".plot").count(), QUANTITIES.length);
    const name = await page.getAttribute(".plot", "aria-label");
    const [least] = /[\d.]+(?= to)/.exec(name);
    const course = predict(0.05, 0.9, [0, 0.2, 0.8, 3.2, 20], "direct").instants.map((instant) => instant.axial_length);
    assert.ok(Number(least) <= Math.min(...course) + 1e-3, `${name}, natively ${course}`);
    await page.selectOption("#along", "ca");
    await settled(page);
    await drawn();
    assert.match(await page.getAttribute(".plot", "aria-label"), /along Ca, steady/);
  });
});

describe("physical units", () => {
  onPage("follow from an experiment's sizes and give them back", `#ca=0.1&al=0.9&t=2${FLAT}`, async (page) => {
    await page.click("#open-units");
    for (const [id, value] of [
      ["side", 60],
      ["viscosity", 2],
      ["modulus", 30],
      ["radius", 27],
      ["mean-velocity", 900],
    ]) {
      await page.fill(`#${id}`, String(value));
    }
    await settled(page);
    const { ca, confinement } = await state(page);
    // Ca = 2e-3 Pa s * 0.9 m/s / 0.03 N/m; a/l = 27 / 30.
    assert.ok(Math.abs(ca - 0.06) < 1e-9 && Math.abs(confinement - 0.9) < 1e-9, `${ca}, ${confinement}`);
    assert.equal(Number(await page.inputValue("#flow-rate")), 3.24);
    await page.click("#close-units");
    const { axial_length, velocity } = native(0.06, 0.9, 2);
    assert.ok(Math.abs(Number(await page.innerText("#axial_length")) - 30 * axial_length) < 1e-2);
    assert.ok(Math.abs(Number(await page.innerText("#velocity")) - 900 * velocity) < 0.1);
    assert.match(await page.innerText("#readouts"), /µm/);
    assert.equal(await page.innerText("#time-unit"), "ms");
    // 2 l/V in ms: 2 * 30 um / 900 mm/s.
    assert.ok(Math.abs(Number(await page.inputValue("#time-value")) - 60 / 900) < 1e-3);
    assert.match(await page.innerText("#midplane"), /µm/);
    await page.click("#open-units");
    await page.click("#dimensionless");
    await settled(page);
    assert.equal(await page.innerText("#axial_length"), axial_length.toFixed(4));
  });
});

describe("export", () => {
  onPage(
    "gives numbers that are the native core's",
    `#ca=0.1&al=0.9&t=3&pins=A:paper:0.05,0.8${FLAT}`,
    async (page) => {
      const json = await save(page, "Read-outs, now and along time, JSON");
      const content = JSON.parse(json.bytes.toString());
      const whole = predict(0.1, 0.9, [3], "direct");
      assert.equal(content.model_digest, whole.model_digest);
      assert.equal(`${content.errors_against} G_s a^2`.slice(0, 30), whole.errors_against.slice(0, 30));
      assert.ok(json.name.includes(whole.model_digest));
      const pairs = [
        [content.traces[0].instant, native(0.1, 0.9, 3)],
        [content.traces[1].instant, native(0.05, 0.8, 3, "paper")],
        [content.traces[0].course.find(({ t }) => t === 6), native(0.1, 0.9, 6)],
      ];
      for (const [found, expected] of pairs) {
        for (const quantity of QUANTITIES) {
          assert.equal(Math.fround(found[quantity]), Math.fround(expected[quantity]), quantity);
        }
      }
      const csv = (await save(page, "Read-outs, now and along time, CSV")).bytes.toString().split("\n");
      const head = csv.findIndex((line) => !line.startsWith("#"));
      assert.ok(csv.slice(0, head).some((line) => line.includes(whole.model_digest)));
      const columns = csv[head].split(",");
      const row = csv.find((line) => line.startsWith("live,0.1,0.9,direct,3,")).split(",");
      assert.equal(Math.fround(row[columns.indexOf("volume")]), Math.fround(native(0.1, 0.9, 3).volume));
    },
  );

  onPage("gives a surface that holds the capsule's volume", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const { bytes } = await save(page, "Surface, lengths in l, STL");
    const count = bytes.readUInt32LE(80);
    assert.equal(bytes.length, 84 + 50 * count);
    const facet = (i) => Array.from({ length: 9 }, (_, k) => bytes.readFloatLE(84 + 50 * i + 12 + 4 * k));
    const points = Array.from({ length: count }, (_, i) => facet(i)).flat();
    const found = volumeOf(points, [...Array(3 * count).keys()]);
    const { volume } = await figures(page);
    assert.ok(Math.abs(found / volume - 1) < 2e-3, `STL ${found}, core ${volume}`);
  });

  onPage("gives the surface to other programs", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const { volume } = await figures(page);
    const close = (found) => assert.ok(Math.abs(found / volume - 1) < 2e-3, `volume ${found}, core ${volume}`);
    const rows = (text, name) =>
      text.filter((line) => line.startsWith(`${name} `)).map((line) => line.split(" ").slice(1));

    const obj = (await save(page, "Surface, lengths in l, OBJ")).bytes.toString().split("\n");
    const points = rows(obj, "v").flat().map(Number);
    const corners = rows(obj, "f")
      .flat()
      .map((corner) => Number(corner.split("//")[0]) - 1);
    close(volumeOf(points, corners));
    assert.equal(rows(obj, "vn").length, points.length / 3);
    assert.ok(obj.some((line) => /^# CapsuleExplorer, model [0-9a-f]{8}/.test(line)));

    const vtp = (await save(page, "Surface, lengths in l, VTP")).bytes.toString();
    const arrays = await page.evaluate((source) => {
      const parsed = new DOMParser().parseFromString(source, "text/xml");
      const named = [...parsed.querySelectorAll("DataArray")].map((one) => [one.getAttribute("Name"), one.textContent]);
      return { ...Object.fromEntries(named), count: parsed.querySelector("Piece").getAttribute("NumberOfPolys") };
    }, vtp);
    const numbers = (name) => arrays[name].trim().split(/\s+/).map(Number);
    close(volumeOf(numbers("Points"), numbers("connectivity")));
    assert.equal(numbers("offsets").at(-1), 3 * Number(arrays.count));
    // The nodes of a sphere of 0.9 l, moved by their displacements, are those of the shape.
    const displacement = numbers("displacement");
    const start = numbers("Points").map((x, i) => x - displacement[i]);
    assert.ok(start.every((x) => Math.abs(x) < 0.9 * 1.01));
  });

  onPage("gives the motion as an animation", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const { bytes, name } = await save(page, "Surface, lengths in l, GLB, moving");
    assert.match(name, /\.glb$/);
    assert.equal(bytes.toString("latin1", 0, 4), "glTF");
    assert.equal(bytes.readUInt32LE(8), bytes.length);
    const length = bytes.readUInt32LE(12);
    const scene = JSON.parse(bytes.toString("utf8", 20, 20 + length));
    const read = (index) => {
      const { bufferView, componentType, count, type, byteOffset = 0 } = scene.accessors[index];
      const from = 20 + length + 8 + (scene.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
      const whole = type === "VEC3" ? 3 * count : count;
      const [size, get] = componentType === 5126 ? [4, "readFloatLE"] : [4, "readUInt32LE"];
      return Array.from({ length: whole }, (_, i) => bytes[get](from + size * i));
    };
    const [primitive] = scene.meshes[0].primitives;
    const [{ samplers }] = scene.animations;
    const [times, weights] = [read(samplers[0].input), read(samplers[0].output)];
    assert.deepEqual([times.length, times.at(-1)], [41, 20]);
    // The frame at t = 6, which has a target of its own: the capsule's volume then, and no other target.
    const frame = times.findIndex((t) => Math.abs(t - 6) < 1e-5);
    const shares = weights.slice(40 * frame, 40 * (frame + 1));
    assert.deepEqual(
      shares.flatMap((share, target) => (share === 0 ? [] : [[target, share]])),
      [[frame - 1, 1]],
    );
    const change = read(primitive.targets[frame - 1].POSITION);
    const points = read(primitive.attributes.POSITION).map((x, i) => x + change[i]);
    const { volume } = native(0.1, 0.9, 6);
    assert.ok(Math.abs(volumeOf(points, read(primitive.indices)) / volume - 1) < 2e-3);
  });

  onPage(
    "gives a report that needs nothing else",
    "#ca=0.1&al=0.9&t=3&initial=0&pins=A:paper:0.05,0.8",
    async (page) => {
      await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
      const report = (await save(page, "All of it in one page, HTML")).bytes.toString();
      const { digest, rows, drawings, sources } = await page.evaluate((source) => {
        const parsed = new DOMParser().parseFromString(source, "text/html");
        return {
          digest: /model ([0-9a-f]{8})/.exec(parsed.querySelector("li").textContent)[1],
          rows: [...parsed.querySelectorAll("tbody tr")].map((row) => [...row.cells].map((cell) => cell.textContent)),
          drawings: parsed.querySelectorAll("figure svg path").length,
          sources: [...parsed.querySelectorAll("[src], link, script")].map((part) =>
            (part.src ?? part.href).slice(0, 15),
          ),
        };
      }, report);
      assert.equal(digest, predict(0.1, 0.9, [3], "direct").model_digest);
      const [live, pinned] = [native(0.1, 0.9, 3), native(0.05, 0.8, 3, "paper")];
      assert.deepEqual(rows[0], [
        "Axial length",
        `${live.axial_length.toFixed(4)} ℓ`,
        `${pinned.axial_length.toFixed(4)} ℓ`,
      ]);
      assert.ok(drawings > 5);
      assert.deepEqual(sources, ["data:image/png;"]);
    },
  );

  onPage("gives drawings that stand alone", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    for (const name of [
      "Map of the parameters",
      "Longitudinal section",
      "Transversal section",
      "Read-out along time",
    ]) {
      const text = (await save(page, `${name}, SVG`)).bytes.toString();
      const parts = await page.evaluate((source) => {
        const parsed = new DOMParser().parseFromString(source, "image/svg+xml");
        return {
          root: parsed.documentElement.tagName,
          title: parsed.querySelector("title").textContent,
          words: parsed.querySelector("desc").textContent,
          paths: parsed.querySelectorAll("path").length,
          styled: parsed.querySelectorAll("[class]").length,
        };
      }, text);
      assert.equal(parts.root, "svg");
      assert.equal(parts.title, name);
      assert.match(parts.words, /model [0-9a-f]{8}[\s\S]*Ca = 0\.1[\s\S]*Entropy/);
      assert.ok(parts.paths > 0);
      assert.equal(parts.styled, 0);
    }
    const { bytes } = await save(page, "Diagonal section, PNG");
    assert.equal(bytes.subarray(1, 4).toString(), "PNG");
    const { width } = await page.locator("#diagonal").boundingBox();
    assert.ok(Math.abs(bytes.readUInt32BE(16) - 2 * width) < 4);
  });

  onPage("gives the picture of the space view", "#ca=0.1&al=0.9&t=3&initial=0&views=solid", async (page) => {
    await page.waitForFunction(() => document.querySelector("#solid").dataset.rendered === "true");
    const { bytes } = await save(page, "Capsule in the channel, PNG");
    assert.equal(bytes.subarray(1, 4).toString(), "PNG");
    assert.ok(bytes.length > 20_000, `${bytes.length} bytes`);
  });

  onPage(
    "gives a session that is opened again",
    `#ca=0.07&al=0.85&t=4&frame=centroid&pins=A:direct:0.1,0.9${FLAT}`,
    async (page) => {
      const { name, bytes } = await save(page, "Session, to open again, Save");
      const wanted = await state(page);
      await page.click("#close-take-away");
      await page.evaluate(() => window.capsuleExplorer.set({ ca: 0.1, frame: "laboratory", pins: [], t: 1 }));
      await page.setInputFiles("#model-file", { name, mimeType: "application/json", buffer: bytes });
      await page.waitForFunction(() => window.capsuleExplorer.state.ca === 0.07);
      const { ca, frame, pins, t } = await state(page);
      assert.deepEqual([ca, frame, pins, t], [wanted.ca, wanted.frame, wanted.pins, wanted.t]);
      await page.setInputFiles("#model-file", {
        name: "no.json",
        mimeType: "application/json",
        buffer: Buffer.from("{}"),
      });
      await page.waitForFunction(() => document.body.dataset.status === "failed");
      assert.match(await page.innerText("#failure"), /no\.json is not a session/);
    },
  );
});

describe("the undisturbed flow", () => {
  /** Velocities of the profile in the section, at y = 0 and y = 0.5, in V: from the drawing and its scale. */
  const drawn = (page) =>
    page.evaluate(() => {
      // The line that the arrows begin at, then the profile from wall to wall.
      const [, base, profile] = document.querySelector("#midplane .flow").getAttribute("d").split("M");
      const curve = profile.split("L").map((place) => place.split(" ").map(Number));
      const walls = [...document.querySelectorAll("#midplane line.wall")].map((line) =>
        Number(line.getAttribute("y1")),
      );
      const scale = Math.abs(walls[0] - walls[1]) / 2;
      // An arrow of V is half an l long.
      return [20, 30].map((i) => (curve[i][0] - Number.parseFloat(base)) / (0.5 * scale));
    });
  // The cosine series of a square duct, summed to convergence.
  const EXACT = [2.0962560147, 1.63141622];

  onPage("is drawn in the section in the chosen frame", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    const same = (found, frame) =>
      found.forEach((value, i) => {
        assert.ok(Math.abs(value - (EXACT[i] - frame)) < 2e-3, `${value}, exact ${EXACT[i] - frame}`);
      });
    assert.equal(await page.getAttribute("#midplane .flow", "d"), "");
    await page.check("#profile-midplane");
    await settled(page);
    same(await drawn(page), 0);
    assert.equal(await page.textContent("#midplane .flow-value"), "2.1 V");
    assert.equal(await page.getAttribute("#diagonal .flow", "d"), "");
    await page.check("input[name=frame][value=centroid]", { force: true });
    await settled(page);
    const { velocity } = native(0.1, 0.9, 3);
    same(await drawn(page), velocity);
    await page.waitForFunction(() => /frame=centroid.*profile=1|profile=1.*frame=centroid/.test(window.location.hash));
    await page.reload();
    await page.waitForFunction(() => document.body.dataset.status === "ready");
    await settled(page);
    assert.equal(await page.isChecked("#profile-midplane"), true);
    same(await drawn(page), velocity);
  });

  onPage(
    "is drawn in space",
    "#ca=0.1&al=0.9&t=3&initial=0&views=solid",
    async (page) => {
      await page.waitForSelector("#solid[data-rendered]");
      const picture = () => page.locator("#solid canvas").screenshot();
      const before = await picture();
      assert.deepEqual(await picture(), before);
      await page.check("#profile");
      await settled(page);
      const withFlow = await picture();
      assert.notDeepEqual(withFlow, before);
      await page.uncheck("#profile");
      await settled(page);
      assert.deepEqual(await picture(), before);
    },
    { viewport: { width: 720, height: 560 } },
  );
});

describe("the element", () => {
  onPage("shows what its attributes say, and says what it shows", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    await page.evaluate(() => {
      document.body.insertAdjacentHTML(
        "beforeend",
        '<capsule-explorer ca="0.05" al="0.8" t="6" views="midplane" controls="time" speed="17"></capsule-explorer>',
      );
      const element = document.querySelector("capsule-explorer");
      window.changes = [];
      element.addEventListener("statechange", () => window.changes.push(element.state.ca));
    });
    await page.waitForFunction(() => document.querySelector("capsule-explorer").dataset.status === "ready");
    const read = () => page.evaluate(() => document.querySelector("capsule-explorer").read());
    const same = (found, expected) => {
      for (const quantity of QUANTITIES) {
        assert.equal(Math.fround(found[quantity]), Math.fround(expected[quantity]), quantity);
      }
    };
    same(await read(), native(0.05, 0.8, 6));
    const shown = () =>
      page.$$eval("capsule-explorer > .masthead, capsule-explorer .query, capsule-explorer .transport", (parts) =>
        parts.filter((part) => part.checkVisibility()).map((part) => part.className),
      );
    assert.deepEqual(await shown(), ["transport"]);
    await page.evaluate(() => document.querySelector("capsule-explorer").setAttribute("ca", "0.06"));
    await settled(page);
    same(await read(), native(0.06, 0.8, 6));
    assert.deepEqual(await page.evaluate(() => window.changes.at(-1)), 0.06);
    await page.evaluate(() => {
      const element = document.querySelector("capsule-explorer");
      element.removeAttribute("ca");
      element.setAttribute("controls", "none");
    });
    await settled(page);
    assert.equal((await read()).ca, 0.1);
    assert.deepEqual(await shown(), []);
    // The page's own explorer is another one.
    assert.deepEqual([(await state(page)).ca, (await state(page)).t], [0.1, 3]);
  });

  test("is all that its script brings to another page", async () => {
    const { page: first, close } = await open(`#ca=0.1${FLAT}`);
    const page = await first.context().newPage();
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    // Words and looks of a page that has nothing to do with the explorer, in classes that the explorer has too.
    const own =
      '<h2 class="title">Own</h2><button class="play">Own</button><p class="map">Own</p><svg><text>x</text></svg>';
    const element = '<capsule-explorer ca="0.05" al="0.8" t="6" views="midplane"></capsule-explorer>';
    const body = `<!doctype html><html lang="en"><title>x</title><body>${own}</body></html>`;
    await page.route("**/elsewhere/other.html", (route) => route.fulfill({ contentType: "text/html", body }));
    await page.goto(`${url()}elsewhere/other.html`);
    const looks = () =>
      page.evaluate(() =>
        [
          document.documentElement,
          ...document.querySelectorAll("body, body > :not(capsule-explorer, script), body > svg > text"),
        ].map((part) => {
          const { font, color, backgroundColor, display, margin, padding, borderWidth } = getComputedStyle(part);
          const { height } = part.matches("html, body") ? { height: 0 } : part.getBoundingClientRect();
          return [part.tagName, font, color, backgroundColor, display, margin, padding, borderWidth, height].join();
        }),
      );
    const before = await looks();
    await page.addScriptTag({ url: `${url()}capsule-explorer.js`, type: "module" });
    await page.evaluate(() => customElements.whenDefined("capsule-explorer"));
    assert.equal(await page.locator(".explorer, .masthead").count(), 0);
    assert.equal(await page.evaluate(() => typeof window.capsuleExplorer), "undefined");
    await page.evaluate((markup) => document.body.insertAdjacentHTML("beforeend", markup), element);
    await page.waitForFunction(() => document.querySelector("capsule-explorer").dataset.status === "ready");
    assert.deepEqual(await looks(), before, "the page keeps its looks");
    assert.equal(await page.evaluate(() => document.body.className), "");
    const read = await page.evaluate(() => document.querySelector("capsule-explorer").read());
    for (const quantity of QUANTITIES) {
      assert.equal(Math.fround(read[quantity]), Math.fround(native(0.05, 0.8, 6)[quantity]), quantity);
    }
    assert.equal(await page.isVisible("capsule-explorer .transport"), true);
    const { display } = await page.$eval("capsule-explorer .masthead", (part) => ({ ...getComputedStyle(part) }));
    assert.equal(display, "flex", "the element has its styles");
    const notices = await page.$eval("capsule-explorer [id$=model] a", ({ href }) => href);
    assert.equal(notices, `${url()}THIRD-PARTY.txt`, "the notices are beside the script");
    assert.deepEqual(errors, []);
    await close();
  });

  test("is a page in a frame, with its controls or without", async () => {
    const { page, close } = await open(`?controls=none#ca=0.05&al=0.8&t=6${FLAT}`);
    assert.equal(await page.isVisible("#midplane"), true);
    for (const part of [".masthead", ".query", ".readouts", ".transport"]) {
      assert.equal(await page.isVisible(part), false, part);
    }
    await close();
  });
});

describe("the sheet of keys", () => {
  onPage("opens by ?, and the theme that is chosen there stays", `#ca=0.1&al=0.9&t=3${FLAT}`, async (page) => {
    await page.keyboard.press("?");
    assert.ok(await page.isVisible("#help"));
    await page.selectOption("#theme", "dark");
    assert.equal(await page.getAttribute("body", "data-theme"), "dark");
    await page.keyboard.press("Escape");
    assert.equal(await page.isVisible("#help"), false);
    await page.reload();
    await page.waitForFunction(() => document.body.dataset.status === "ready");
    assert.equal(await page.getAttribute("body", "data-theme"), "dark");
  });

  test("is not needed to learn what a browser without a program is missing", async () => {
    const { page: first, close } = await open("#views=midplane");
    const context = await first.context().browser().newContext({ javaScriptEnabled: false });
    const page = await context.newPage();
    await page.goto(url());
    assert.match(await page.innerText("noscript p"), /JavaScript and WebAssembly/);
    await context.close();
    await close();
  });
});
