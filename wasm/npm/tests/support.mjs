// Shared by the tests: the packages, installed from their archives into a folder of their own.

import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { extname, join, resolve } from "node:path";
import { after } from "node:test";
import { pathToFileURL } from "node:url";

const ROOT = resolve(import.meta.dirname, "../../..");

/** The folder of the archives, as `cargo xtask npm` makes them. */
const ARCHIVES = resolve(process.env.CAPSULE_NPM ?? join(ROOT, "target/npm"));
export const archives = readdirSync(ARCHIVES)
  .filter((name) => name.endsWith(".tgz"))
  .map((name) => join(ARCHIVES, name));

/** Runs a program in a folder and returns its output; throws with all that it said. */
export function run(folder, program, ...options) {
  try {
    return execFileSync(program, options, { cwd: folder, encoding: "utf8", stdio: "pipe" });
  } catch (error) {
    throw new Error(`${program} ${options.join(" ")}\n${error.stdout}\n${error.stderr}`);
  }
}

/** A clean folder with both packages, removed after the tests of the file. */
export function project() {
  const folder = mkdtempSync(join(tmpdir(), "capsule-npm-"));
  after(() => rmSync(folder, { recursive: true }));
  writeFileSync(join(folder, "package.json"), '{ "private": true, "type": "module" }\n');
  run(folder, "npm", "install", "--offline", "--no-audit", "--no-fund", ...archives);
  const { resolve: find } = createRequire(join(folder, "index.js"));
  return {
    folder,
    /** Writes a file and returns its path. */
    written: (name, content) => {
      writeFileSync(join(folder, name), content);
      return join(folder, name);
    },
    /** The module that the folder's own scripts would import by this name. */
    imported: (name) => import(pathToFileURL(find(name)).href),
  };
}

/** The text of a document of the repository. */
export const textOf = (document) => readFileSync(join(ROOT, document), "utf8");

/** The examples of a language in a document. */
export function examples(document, language) {
  return [...textOf(document).matchAll(/^```(\w+)\n(.*?)^```$/gms)]
    .filter(([, of]) => of === language)
    .map(([, , code]) => code);
}

/** The page's compiler of TypeScript. */
export const TSC = join(ROOT, "wasm/explorer/node_modules/typescript/bin/tsc");

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

/** Serves a folder as it is. Returns its address and how to stop it. */
export function serve(folder) {
  const server = createServer((request, response) => {
    const path = join(folder, decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    try {
      const bytes = readFileSync(path);
      response.writeHead(200, { "Content-Type": TYPES[extname(path)] ?? "application/octet-stream" }).end(bytes);
    } catch {
      // A browser asks for an icon of its own accord.
      response.writeHead(path.endsWith("favicon.ico") ? 204 : 404).end();
    }
  });
  return new Promise((ready) => {
    server.listen(0, "127.0.0.1", () =>
      ready({ url: `http://127.0.0.1:${server.address().port}/`, stop: () => server.close() }),
    );
  });
}
