import { interpolateRdBu, interpolateViridis } from "d3-scale-chromatic";
import { Color, DataTexture, LinearFilter, SRGBColorSpace, type Texture } from "three";

/** Colours of magnitudes, and of values on two sides of a centre: both are told apart by the colour-blind. */
export type ColourMap = "sequential" | "diverging";

const COUNT = 256;

const AT: Record<ColourMap, (share: number) => string> = {
  sequential: interpolateViridis,
  // Red above the centre, blue below it.
  diverging: (share) => interpolateRdBu(1 - share),
};

/** Colours evenly along a map, as CSS writes them. */
export function colours(map: ColourMap, count: number): string[] {
  return Array.from({ length: count }, (_, i) => AT[map](i / (count - 1)));
}

/** A map as a texture along u: between two vertices the value is interpolated, not the colour. */
export function colourTexture(map: ColourMap): Texture {
  const at = new Color();
  const pixels = colours(map, COUNT).flatMap((colour) => {
    at.set(colour).getRGB(at, SRGBColorSpace);
    return [...at.toArray().map((part) => Math.round(255 * part)), 255];
  });
  const texture = new DataTexture(Uint8Array.from(pixels), COUNT, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
