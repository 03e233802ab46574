/**
 * Has the browser keep the page, so that it works without a network, and offers a new version where there is one. Only
 * for the page itself: a page that embeds an explorer decides on its own what is kept.
 */
export async function keepOffline(offer: HTMLButtonElement): Promise<void> {
  const isOwnPage = document.querySelector('link[rel="manifest"]') !== null && window.self === window.top;
  if (!import.meta.env.PROD || !isOwnPage || !("serviceWorker" in navigator)) return;
  const { serviceWorker } = navigator;
  let registration: ServiceWorkerRegistration;
  try {
    registration = await serviceWorker.register("./service-worker.js");
  } catch {
    // Kept or not, the page works as long as the server does.
    return;
  }
  const show = () => {
    // Without a controller it is the first version that waits for nothing.
    offer.hidden = registration.waiting === null || serviceWorker.controller === null;
  };
  offer.addEventListener("click", () => {
    // The address restores what is on screen.
    serviceWorker.addEventListener("controllerchange", () => window.location.reload(), { once: true });
    registration.waiting?.postMessage("take over");
  });
  registration.addEventListener("updatefound", () => registration.installing?.addEventListener("statechange", show));
  show();
}
