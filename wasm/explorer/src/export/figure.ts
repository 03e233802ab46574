import { set, svg } from "../views/svg";

/** How a drawing looks, besides its attributes: these come from the page's style sheets. */
const PROPERTIES = [
  "fill",
  "fill-opacity",
  "stroke",
  "stroke-width",
  "stroke-dasharray",
  "stroke-linejoin",
  "opacity",
  "paint-order",
  "font-family",
  "font-size",
  "font-style",
  "font-weight",
  "visibility",
];
const FOOT = 22;
const SCALE = 2;

/** The words that go with a figure: its name, a line below it, and all that is to be known of it. */
export interface Legend {
  readonly title: string;
  readonly foot: string;
  readonly description: string;
}

/** All drawings of an element as one SVG that needs no style sheet. */
export function figureSvg(stage: Element, legend: Legend): SVGSVGElement {
  const box = stage.getBoundingClientRect();
  const whole = canvas(box.width, box.height, stage, legend);
  for (const drawing of stage.querySelectorAll<SVGSVGElement>("svg")) {
    const { left, top, width, height } = drawing.getBoundingClientRect();
    if (width === 0) continue;
    const copy = standalone(drawing);
    set(copy, { x: left - box.left, y: top - box.top, width, height });
    copy.removeAttribute("class");
    for (const hidden of copy.querySelectorAll(".surface, .grip, .focus-ring")) hidden.remove();
    whole.append(copy);
  }
  return whole;
}

/** A picture with its words, as one SVG holds them: its ground, title, description and foot. */
function canvas(width: number, height: number, stage: Element, { title, foot, description }: Legend): SVGSVGElement {
  const style = getComputedStyle(stage);
  const whole = svg("svg", { viewBox: `0 0 ${width} ${height + FOOT}`, width, height: height + FOOT });
  svg("title", {}, whole).textContent = title;
  svg("desc", {}, whole).textContent = description;
  const ground = style.getPropertyValue("--ground").trim();
  svg("rect", { width: "100%", height: "100%", fill: ground }, whole);
  const ink = style.getPropertyValue("--ink-soft").trim();
  const line = svg(
    "text",
    { x: 4, y: height + FOOT - 6, "font-size": 9, "font-family": "sans-serif", fill: ink },
    whole,
  );
  line.textContent = foot;
  // One line has the figure's width, however long it is.
  if (foot.length * 4.6 > width) set(line, { textLength: width - 8, lengthAdjust: "spacingAndGlyphs" });
  return whole;
}

function inlineStyles(from: Element, to: Element): void {
  const style = getComputedStyle(from);
  for (const property of PROPERTIES) {
    const value = style.getPropertyValue(property);
    if (value !== "") to.setAttribute(property, value);
  }
  to.removeAttribute("class");
  [...from.children].forEach((child, i) => {
    const copy = to.children[i];
    if (copy !== undefined) inlineStyles(child, copy);
  });
}

export function svgText(figure: SVGSVGElement): string {
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(figure)}\n`;
}

/** A figure as pixels, two for each of the screen's. */
export async function figurePng(figure: SVGSVGElement): Promise<Blob> {
  const [width, height] = [Number(figure.getAttribute("width")), Number(figure.getAttribute("height"))];
  const image = await imageOf(figure, width, height);
  return paint(width, height, (context) => context.drawImage(image, 0, 0, width, height));
}

/** The space view, its words, and the scale of its colours where it has any. */
export interface Picture {
  readonly canvas: HTMLCanvasElement;
  readonly legend: Legend;
  readonly scale: SVGSVGElement | undefined;
}

/** The size of a picture with its foot, in CSS pixels. */
export function pictureSize({ canvas }: Picture): readonly [width: number, height: number] {
  const { width, height } = canvas.getBoundingClientRect();
  return [width, height + FOOT];
}

/** Draws the space view with its ground, its foot and the scale of its colours; the context is in CSS pixels. */
export async function drawPicture(context: CanvasRenderingContext2D, picture: Picture): Promise<void> {
  // Taken in the task that draws it: the browser may clear it afterwards.
  const taken = await createImageBitmap(picture.canvas);
  const { scale, legend } = picture;
  const [width, whole] = pictureSize(picture);
  const height = whole - FOOT;
  context.drawImage(await imageOf(canvas(width, height, picture.canvas, legend), width, whole), 0, 0, width, whole);
  context.drawImage(taken, 0, 0, width, height);
  taken.close();
  if (scale === undefined) return;
  const over = await imageOf(standalone(scale), ...scaleSize(scale));
  context.drawImage(over, width - over.width - 8, height - over.height - 8);
}

export function picturePng(picture: Picture): Promise<Blob> {
  return paint(...pictureSize(picture), (context) => drawPicture(context, picture));
}

function scaleSize(scale: SVGSVGElement): readonly [number, number] {
  const { width, height } = scale.getBoundingClientRect();
  return [width, height];
}

/** A drawing that needs no style sheet. */
function standalone(drawing: SVGSVGElement): SVGSVGElement {
  const copy = drawing.cloneNode(true) as SVGSVGElement;
  inlineStyles(drawing, copy);
  return copy;
}

async function imageOf(drawing: SVGSVGElement, width: number, height: number): Promise<HTMLImageElement> {
  const image = new Image(width, height);
  image.src = `data:image/svg+xml,${encodeURIComponent(svgText(drawing))}`;
  await image.decode();
  return image;
}

async function paint(
  width: number,
  height: number,
  draw: (context: CanvasRenderingContext2D) => void | Promise<void>,
): Promise<Blob> {
  const page = Object.assign(document.createElement("canvas"), { width: SCALE * width, height: SCALE * height });
  const context = page.getContext("2d");
  if (context === null) throw new Error("this browser draws no pixels");
  context.scale(SCALE, SCALE);
  await draw(context);
  return new Promise((made, failed) => {
    page.toBlob((blob) => (blob === null ? failed(new Error("this browser makes no PNG")) : made(blob)), "image/png");
  });
}
