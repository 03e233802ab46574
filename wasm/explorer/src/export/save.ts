import { html } from "../app/dom";

/** Gives a file to the browser to save. */
export function save(name: string, content: BlobPart): void {
  const address = URL.createObjectURL(content instanceof Blob ? content : new Blob([content]));
  html("a", { href: address, download: name }).click();
  window.setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
