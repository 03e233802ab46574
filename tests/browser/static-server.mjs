// A server of static files, as hosts have them: the page of a folder, types of files, 404.

import { existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";

const TYPES = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".css": "text/css",
  ".json": "application/json",
  ".wasm": "application/wasm",
  ".txt": "text/plain; charset=utf-8",
  ".svg": "image/svg+xml",
  ".woff2": "font/woff2",
  ".webmanifest": "application/manifest+json",
};

/**
 * Serves a folder below a path, as a server of several sites does. `change` may replace a file's bytes.
 * Returns the address; `stop` cuts the network.
 */
export async function serveFolder(folder, { change = (_, bytes) => bytes } = {}) {
  const BELOW = "/explorer/";
  if (!existsSync(join(folder, "index.html"))) {
    throw new Error(`${folder} has no page: \`cargo xtask explore --build-only\` builds it`);
  }
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, "http://x");
    const name = normalize(decodeURIComponent(pathname.slice(BELOW.length) || "index.html"));
    const file = join(folder, name);
    if (!pathname.startsWith(BELOW) || name.startsWith("..") || !existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    const type = TYPES[extname(file)] ?? "application/octet-stream";
    const bytes = change(name, readFileSync(file));
    response.writeHead(200, { "Content-Type": type, "Content-Length": bytes.length }).end(bytes);
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  const stop = () => {
    server.close();
    server.closeAllConnections();
  };
  return { url: `http://127.0.0.1:${server.address().port}${BELOW}`, stop };
}
