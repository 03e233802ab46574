import { createHash } from "node:crypto";
import { createReadStream, existsSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { defineConfig, type Plugin } from "vite";

/** The model that the page opens first; another one is built in with CAPSULE_MODEL=FILE. */
const MODEL = resolve(import.meta.dirname, process.env.CAPSULE_MODEL ?? "../../models/capsule.crom");
const SERVED_AS = "capsule.crom";
const ELEMENT = "capsule-explorer";

/** Puts the model beside the page: a file of the build, and a route of the development server. */
function shippedModel(): Plugin {
  return {
    name: "shipped-model",
    configureServer(server) {
      server.middlewares.use(`/${SERVED_AS}`, (_request, response) => {
        if (!existsSync(MODEL)) {
          response.writeHead(404).end();
          return;
        }
        response.writeHead(200, { "Content-Type": "application/octet-stream" });
        createReadStream(MODEL).pipe(response);
      });
    },
    generateBundle() {
      if (!existsSync(MODEL)) {
        this.error(`the model ${MODEL} is missing: build it with \`capsule-rom offline build\`, or set CAPSULE_MODEL`);
      }
      this.emitFile({ type: "asset", fileName: SERVED_AS, source: readFileSync(MODEL) });
    },
  };
}

/** Has the WebAssembly module of the page fetched beside its program, and not after it. */
function preloadedModule(): Plugin {
  return {
    name: "preloaded-module",
    transformIndexHtml: {
      order: "post",
      handler: (_, { bundle }) =>
        Object.keys(bundle ?? {})
          .filter((name) => name.includes("capsule_wasm") && name.endsWith(".wasm"))
          .map((name) => ({
            tag: "link",
            attrs: { rel: "preload", as: "fetch", type: "application/wasm", crossorigin: "", href: `./${name}` },
            injectTo: "head",
          })),
    },
  };
}

/** Writes the service worker: which files the page has, and a digest of them as its version. */
function serviceWorker(): Plugin {
  const NAME = "service-worker.js";
  let folder = "";
  return {
    name: "service-worker",
    apply: "build",
    configResolved({ root, build }) {
      folder = resolve(root, build.outDir);
    },
    closeBundle() {
      const found = readdirSync(folder, { recursive: true, withFileTypes: true });
      const paths = found.filter((entry) => entry.isFile()).map((entry) => resolve(entry.parentPath, entry.name));
      const files = paths.map((path) => path.slice(folder.length + 1).replaceAll("\\", "/")).sort();
      const digest = createHash("sha256");
      for (const file of files) digest.update(file).update(readFileSync(resolve(folder, file)));
      const version = digest.digest("hex").slice(0, 16);
      // A server gives the page itself for the folder.
      const names = files.map((file) => (file === "index.html" ? "./" : `./${file}`));
      const text = readFileSync(resolve(import.meta.dirname, "src/offline", NAME), "utf8");
      const head = `const VERSION = ${JSON.stringify(version)};\nconst FILES = ${JSON.stringify(names)};\n`;
      writeFileSync(resolve(folder, NAME), head + text);
    },
  };
}

export default defineConfig({
  // The page works from any folder of a server, and a missing file is a 404, not the page again.
  base: "./",
  appType: "mpa",
  plugins: [shippedModel(), preloadedModule(), serviceWorker()],
  worker: { format: "es" },
  build: {
    target: "es2023",
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 800,
    // The licences of the bundled packages; `cargo xtask explore` adds those of the module's crates.
    license: { fileName: "THIRD-PARTY.txt" },
    rolldownOptions: {
      // The page, and the script of the element, which other pages load by its name.
      input: {
        page: resolve(import.meta.dirname, "index.html"),
        [ELEMENT]: resolve(import.meta.dirname, "src/main.ts"),
      },
      output: { entryFileNames: ({ name }) => (name === ELEMENT ? "[name].js" : "assets/[name]-[hash].js") },
    },
  },
  server: { port: 5173, strictPort: true },
});
