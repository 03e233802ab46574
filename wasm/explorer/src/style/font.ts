import latin from "@fontsource-variable/ibm-plex-sans/files/ibm-plex-sans-latin-wght-normal.woff2?url";

/** Loads the Latin part of the page's font alone: the few letters beyond it come from the system's fonts. */
export function loadFont(): void {
  const face = new FontFace("IBM Plex Sans Variable", `url(${latin}) format("woff2")`, {
    weight: "100 700",
    display: "swap",
    unicodeRange: "U+0000-00FF, U+0152-0153, U+2000-206F, U+2212",
  });
  document.fonts.add(face);
}
