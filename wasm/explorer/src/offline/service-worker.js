// Keeps the files of one build of the page, so that it works without a network. The build puts two constants before
// this text: VERSION, the digest of all files, and FILES, their names.
/* global VERSION, FILES */

const PREFIX = "capsule-explorer-";
const NAME = PREFIX + VERSION;

self.addEventListener("install", (event) => {
  // Past the browser's own cache where the server says that a file has changed.
  const requests = FILES.map((file) => new Request(file, { cache: "no-cache" }));
  event.waitUntil(caches.open(NAME).then((cache) => cache.addAll(requests)));
});

// The page asks for it when a person wants the new version; else it takes over when the last page is closed.
self.addEventListener("message", (event) => {
  if (event.data === "take over") self.skipWaiting();
});

self.addEventListener("activate", (event) => {
  // The build before stays as well: a page of it that is still open may ask for more of its files.
  const old = async () => {
    const names = (await caches.keys()).filter((name) => name.startsWith(PREFIX) && name !== NAME);
    await Promise.all(names.slice(0, -1).map((name) => caches.delete(name)));
  };
  event.waitUntil(old());
});

self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method !== "GET" || new URL(request.url).origin !== self.location.origin) return;
  const answer = async () => {
    const options = { ignoreSearch: request.mode === "navigate", ignoreVary: true };
    const key = request.url.replace(/\/index\.html(?=$|[?#])/, "/");
    const cache = await caches.open(NAME);
    return (await cache.match(key, options)) ?? (await caches.match(key, options)) ?? fetch(request);
  };
  event.respondWith(answer());
});
