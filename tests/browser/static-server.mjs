// A server of static files, as hosts have them: the page of a folder, types of files, compression, 404.

import { existsSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { brotliCompressSync, gzipSync } from "node:zlib";

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
/** Compressed already. */
const DENSE = new Set([".woff2", ".png"]);

/**
 * Serves a folder below a path, as a server of several sites does. `change` may replace a file's bytes, and with
 * `isCompressed` they go as brotli or gzip to who accepts it. Returns the address; `stop` cuts the network.
 */
export async function serveFolder(folder, { change = (_, bytes) => bytes, isCompressed = false } = {}) {
  const BELOW = "/explorer/";
  if (!existsSync(join(folder, "index.html"))) {
    throw new Error(`${folder} has no page: \`cargo xtask explore --build-only\` builds it`);
  }
  const compressed = new Map();
  const encode = (name, bytes, accepted) => {
    const [encoding, compress] = accepted.includes("br") ? ["br", brotliCompressSync] : ["gzip", gzipSync];
    const key = `${encoding} ${name}`;
    if (!compressed.has(key)) compressed.set(key, compress(bytes));
    return [compressed.get(key), { "Content-Encoding": encoding, Vary: "Accept-Encoding" }];
  };
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, "http://x");
    const name = normalize(decodeURIComponent(pathname.slice(BELOW.length) || "index.html"));
    const file = join(folder, name);
    if (!pathname.startsWith(BELOW) || name.startsWith("..") || !existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    const type = TYPES[extname(file)] ?? "application/octet-stream";
    const accepted = request.headers["accept-encoding"] ?? "";
    const bytes = change(name, readFileSync(file));
    const isDense = !isCompressed || DENSE.has(extname(file)) || !/\b(br|gzip)\b/.test(accepted);
    const [body, more] = isDense ? [bytes, {}] : encode(name, bytes, accepted);
    response.writeHead(200, { "Content-Type": type, "Content-Length": body.length, ...more }).end(body);
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  const stop = () => {
    server.close();
    server.closeAllConnections();
  };
  return { url: `http://127.0.0.1:${server.address().port}${BELOW}`, stop };
}
