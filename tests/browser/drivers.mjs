// Firefox and WebKitGTK by WebDriver, with those methods of a page of Playwright that the helpers of the tests use.

import { spawn } from "node:child_process";
import { existsSync, readdirSync, writeFileSync } from "node:fs";
import { delimiter, join } from "node:path";
import { Builder, By, Capabilities, Key } from "selenium-webdriver";
import firefox from "selenium-webdriver/firefox.js";
import remote from "selenium-webdriver/remote/index.js";

/** How long a page may take for what a test waits for, in ms. */
const PATIENCE = 120_000;
const KEYS = {
  Space: Key.SPACE,
  Enter: Key.ENTER,
  Tab: Key.TAB,
  Escape: Key.ESCAPE,
  ArrowRight: Key.ARROW_RIGHT,
  ArrowUp: Key.ARROW_UP,
};

/** The path of a program, by the first of its names that is there. */
function program(...names) {
  const folders = process.env.PATH.split(delimiter);
  return names.flatMap((name) => folders.map((folder) => join(folder, name))).find(existsSync);
}

/** WebKitGTK's own small browser, which lies beside its library. */
function miniBrowser() {
  const folders = readdirSync("/usr/lib").map((name) => join("/usr/lib", name));
  const places = ["webkitgtk-6.0", "webkit2gtk-4.1"].flatMap((api) => folders.map((folder) => join(folder, api)));
  return places.map((place) => join(place, "MiniBrowser")).find(existsSync);
}

const Xvfb = program("Xvfb");

/** The driver, the browser and the screen that each needs, what brings them, and what the driver is asked for. */
export const BROWSERS = {
  Firefox: {
    programs: { geckodriver: program("geckodriver"), "firefox-esr": program("firefox-esr", "firefox"), Xvfb },
    install: "apt-get install firefox-esr xvfb; cargo install geckodriver",
    ask: (binary) => new Builder().forBrowser("firefox").setFirefoxOptions(new firefox.Options().setBinary(binary)),
  },
  WebKitGTK: {
    programs: { WebKitWebDriver: program("WebKitWebDriver"), MiniBrowser: miniBrowser(), Xvfb },
    install: "apt-get install webkit2gtk-driver xvfb",
    ask: (binary) =>
      new Builder().withCapabilities(
        new Capabilities({
          browserName: "MiniBrowser",
          "webkitgtk:browserOptions": { binary, args: ["--automation"] },
        }),
      ),
  },
};

/** Starts a browser: its page, its name and version, and what ends it. */
export async function startDriven({ programs, ask }) {
  const [path, browser, screenPath] = Object.values(programs);
  const screen = await startScreen(screenPath);
  const service = new remote.DriverService.Builder(path)
    .setLoopback(true)
    .setEnvironment({ ...process.env, DISPLAY: screen.name })
    .build();
  let driver;
  const stop = async () => {
    await driver?.quit();
    await service.kill();
    screen.stop();
  };
  try {
    driver = await ask(browser)
      .usingServer(await service.start())
      .build();
    await driver.manage().setTimeouts({ script: PATIENCE });
    const capabilities = await driver.getCapabilities();
    const version = `${capabilities.getBrowserName()} ${capabilities.getBrowserVersion()}`;
    return { page: new Page(driver), version, stop };
  } catch (error) {
    await stop();
    throw error;
  }
}

/** A screen that nobody sees: without one WebKitGTK does not run, and Firefox has no WebGL. */
async function startScreen(path) {
  const server = spawn(path, ["-displayfd", "3", "-screen", "0", "1600x1100x24", "-nolisten", "tcp"], {
    stdio: ["ignore", "ignore", "ignore", "pipe"],
  });
  const number = await new Promise((found, failed) => {
    server.stdio[3].once("data", (text) => found(String(text).trim()));
    server.once("exit", (code) => failed(new Error(`Xvfb ended with exit code ${code}`)));
  });
  return { name: `:${number}`, stop: () => server.kill() };
}

/** Programs that a browser needs and that are missing, by name. */
export function missing({ programs }) {
  return Object.keys(programs).filter((name) => programs[name] === undefined);
}

/** A page, by the names that Playwright has for the same. */
export class Page {
  constructor(driver) {
    this.driver = driver;
  }

  async resize(width, height) {
    const outer = this.driver.manage().window();
    await outer.setRect({ x: 0, y: 0, width, height });
    const inner = await this.evaluate(() => [window.innerWidth, window.innerHeight]);
    await outer.setRect({ x: 0, y: 0, width: 2 * width - inner[0], height: 2 * height - inner[1] });
  }

  goto(address) {
    return this.driver.get(address);
  }

  /** Puts the page into a frame of this size, since windows have a least width; the methods are those of the frame. */
  async enterFrame(width, height) {
    await this.evaluate(
      ([w, h]) => {
        const frame = document.createElement("iframe");
        frame.src = window.location.pathname + window.location.hash;
        frame.style = `border: 0; width: ${w}px; height: ${h}px`;
        document.documentElement.style.overflow = "hidden";
        document.body.replaceChildren(frame);
      },
      [width, height],
    );
    await this.driver.switchTo().frame(0);
  }

  /** Runs a function in the page, and waits for its promise. */
  async evaluate(task, argument) {
    const script = `
      const done = arguments[1];
      new Promise((found) => found((${task})(arguments[0]))).then(
        (value) => done({ value }),
        (error) => done({ error: String(error) }),
      );
    `;
    const { value, error } = await this.driver.executeAsyncScript(script, argument);
    if (error !== undefined) throw new Error(`in the page: ${error}`);
    return value ?? undefined;
  }

  async waitForFunction(task, argument) {
    await this.driver.wait(() => this.evaluate(task, argument), PATIENCE, `${task}`, 50);
  }

  waitForSelector(selector) {
    return this.waitForFunction((wanted) => document.querySelector(wanted) !== null, selector);
  }

  #find(selector) {
    return this.driver.findElement(By.css(selector));
  }

  $$eval(selector, task) {
    return this.evaluate(`(selector) => (${task})([...document.querySelectorAll(selector)])`, selector);
  }

  getAttribute(selector, name) {
    return this.evaluate(`(selector) => document.querySelector(selector).getAttribute("${name}")`, selector);
  }

  innerText(selector) {
    return this.evaluate((wanted) => document.querySelector(wanted).innerText, selector);
  }

  click(selector) {
    return this.#find(selector).click();
  }

  /** Types in place of what is there. */
  async fill(selector, text) {
    const input = await this.#find(selector);
    await input.sendKeys(Key.chord(Key.CONTROL, "a"));
    await input.sendKeys(String(text));
  }

  setInputFiles(selector, path) {
    return this.#find(selector).sendKeys(path);
  }

  /** Presses a key, with others held down: "Shift+ArrowRight". */
  async press(keys) {
    const names = keys.split("+");
    const pressed = names.pop();
    const actions = this.driver.actions();
    for (const name of names) actions.keyDown(Key[name.toUpperCase()]);
    actions.sendKeys(KEYS[pressed] ?? pressed);
    for (const name of names) actions.keyUp(Key[name.toUpperCase()]);
    await actions.perform();
  }

  /** Moves the mouse to each place with the button held down from the first: of one place, a click. */
  async drag(...places) {
    const actions = this.driver.actions();
    for (const [i, [x, y]] of places.entries()) {
      actions.move({ x: Math.round(x), y: Math.round(y), duration: 50 });
      if (i === 0) actions.press();
    }
    await actions.release().perform();
  }

  async screenshot(path) {
    writeFileSync(path, await this.driver.takeScreenshot(), "base64");
  }
}
