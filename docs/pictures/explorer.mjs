// Takes the picture of the page: `cargo xtask explore --build-only`, then `node docs/pictures/explorer.mjs`.

import { resolve } from "node:path";
import { openPage, serve, settled, startBrowser } from "../../tests/browser/support.mjs";

const server = await serve();
const browser = await startBrowser();
const { page, close } = await openPage(browser, `${server.url}#ca=0.1&al=0.9&t=3`, {
  viewport: { width: 1440, height: 900 },
  deviceScaleFactor: 0.6,
});
await settled(page);
await page.screenshot({ path: resolve(import.meta.dirname, "explorer.png") });
await close();
await browser.close();
server.stop();
