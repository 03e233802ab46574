// Random use of every control: `npm run random -- 10000` for as many steps as one likes; random.test.mjs takes fewer.

import { pathToFileURL } from "node:url";
import { openPage, serve, settled, startBrowser } from "./support.mjs";

/** Before the page's own program: keeps the module's memory where it can be measured. */
function keepMemory() {
  const { instantiateStreaming } = WebAssembly;
  WebAssembly.instantiateStreaming = async (...source) => {
    const made = await instantiateStreaming(...source);
    window.wasmMemory = made.instance.exports.memory;
    return made;
  };
}

/** Runs in the page: so many steps, each at a control that a person could reach then. */
async function walk({ steps, seed }) {
  let state = seed;
  // Linear congruential, modulus 2^31: the same walk in every run.
  const random = (n) => {
    state = (1103515245 * state + 12345) % 2147483648;
    return Math.floor((state / 2147483648) * n);
  };
  const pick = (values) => values[random(values.length)];
  // Files and the clipboard are the browser's; a film takes longer than all the rest.
  const avoided = "#open-model, #model-file, #copy-link, #take-away-list button, a";
  const keys = [
    " ",
    "ArrowLeft",
    "ArrowRight",
    "ArrowUp",
    "ArrowDown",
    "Home",
    "End",
    "?",
    "l",
    "1",
    "2",
    "3",
    "+",
    "-",
  ];
  const isThere = (element) => element.checkVisibility() && !element.disabled && !element.matches(avoided);
  const act = (element) => {
    if (element instanceof HTMLSelectElement) {
      element.value = pick([...element.options].filter((option) => !option.hidden)).value;
      element.dispatchEvent(new Event("change", { bubbles: true }));
    } else if (element instanceof HTMLInputElement && (element.type === "range" || element.type === "number")) {
      const [least, most] = [Number(element.min || 0), Number(element.max || 1.2)];
      // A tenth beyond the range, and at times no number.
      element.value = random(20) === 0 ? "" : String(least + (random(1101) / 1000) * (most - least));
      element.dispatchEvent(new Event("input", { bubbles: true }));
      element.dispatchEvent(new Event("change", { bubbles: true }));
    } else if (element instanceof SVGElement) {
      const { left, top, width, height } = element.getBoundingClientRect();
      const place = { clientX: left + (random(101) / 100) * width, clientY: top + (random(101) / 100) * height };
      for (const Kind of [PointerEvent, MouseEvent]) {
        const type = Kind === PointerEvent ? "pointermove" : "click";
        element.dispatchEvent(new Kind(type, { ...place, bubbles: true, pointerType: "mouse" }));
      }
    } else {
      element.click();
    }
  };
  const selector = "button, select, input, [role=slider], .surface, .stage svg";
  for (let i = 0; i < steps; i++) {
    const dialog = document.querySelector("dialog:modal");
    const controls = [...(dialog ?? document).querySelectorAll(selector)].filter(isThere);
    if (dialog !== null && random(8) === 0) dialog.close();
    else if (random(5) > 0) act(pick(controls));
    else {
      const target = random(2) === 0 ? document.body : pick(controls);
      target.dispatchEvent(new KeyboardEvent("keydown", { key: pick(keys), shiftKey: random(3) === 0, bubbles: true }));
    }
    if (random(3) === 0) window.capsuleExplorer.read();
    if (random(4) === 0) await new Promise(requestAnimationFrame);
  }
  document.querySelector("dialog:modal")?.close();
  return { next: state, memory: window.wasmMemory.buffer.byteLength };
}

/** Uses a page for so many steps, in parts: the module's memory in bytes after each part, and what the console said. */
export async function useAtRandom(browser, address, steps, seed = 20260101) {
  // A small picture, since an emulated graphics card draws it.
  const options = { before: keepMemory, viewport: { width: 720, height: 560 } };
  const { page, errors, close } = await openPage(browser, address, options);
  const memory = [];
  const parts = 10;
  for (let part = 0, next = seed; part < parts; part++) {
    const done = await page.evaluate(walk, { steps: Math.ceil(steps / parts), seed: next });
    next = done.next;
    memory.push(done.memory);
  }
  await settled(page);
  return { page, errors, memory, close };
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? "").href) {
  const steps = Number(process.argv[2] ?? 10_000);
  const seed = Number(process.argv[3] ?? 20260101);
  const server = await serve();
  const browser = await startBrowser();
  try {
    const { errors, memory } = await useAtRandom(browser, server.url, steps, seed);
    process.stdout.write(`${steps} steps from seed ${seed}, memory of the module in MB:\n`);
    process.stdout.write(`${memory.map((bytes) => (bytes / 2 ** 20).toFixed(1)).join(" ")}\n`);
    for (const error of errors) process.stdout.write(`error: ${error}\n`);
    process.exitCode = errors.length > 0 || memory.at(-1) > 1.1 * memory[4] ? 1 : 0;
  } finally {
    await browser.close();
    server.stop();
  }
}
