import { html } from "../app/dom";
import { QUANTITIES } from "../app/schema";
import { measure, nameOf } from "../model/quantities";
import type { Context, Trace } from "../views/view";

const STYLE = `
  body { font: 15px/1.5 system-ui, sans-serif; color: #1c2733; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
  h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; }
  table { border-collapse: collapse; } th, td { padding: 0.2rem 0.8rem; border-bottom: 1px solid #d5dde5; }
  th { text-align: left; font-weight: 600; } td { text-align: right; font-variant-numeric: tabular-nums; }
  figure { margin: 1.5rem 0; break-inside: avoid; } svg, img { max-width: 100%; height: auto; } a { color: #1f5f8f; }
`;

/** A figure of the report. */
export interface ReportFigure {
  readonly name: string;
  readonly drawing: SVGSVGElement | HTMLImageElement;
}

/** What is on screen as one HTML file that needs no other: where it comes from, the read-outs, and the figures. */
export function toReport(
  traces: readonly Trace[],
  context: Context,
  figures: readonly ReportFigure[],
  provenance: readonly string[],
  language: string,
): string {
  const { words } = context;
  const page = document.implementation.createHTMLDocument(`CapsuleExplorer, ${context.capsule.model.title}`);
  page.documentElement.lang = language;
  const style = html("style", { textContent: STYLE });
  const charset = html("meta");
  charset.setAttribute("charset", "utf-8");
  page.head.prepend(charset);
  page.head.append(style);
  const lines = provenance.map((line) =>
    html("li", {}, /^https?:/.test(line) ? html("a", { href: line, textContent: line }) : line),
  );
  page.body.append(
    html("h1", { textContent: context.capsule.model.title }),
    html("ul", {}, ...lines),
    html("h2", { textContent: words.page.readouts }),
    readouts(traces, context),
    html("h2", { textContent: words.export.figures }),
    ...figures.map(({ name, drawing }) => html("figure", {}, drawing, html("figcaption", { textContent: name }))),
  );
  return `<!doctype html>\n${page.documentElement.outerHTML}\n`;
}

/** The read-outs of all traces at the instant, a column each. */
function readouts(traces: readonly Trace[], { units, words }: Context): HTMLTableElement {
  const heads = traces.map(({ name }) => {
    return html("th", { scope: "col", textContent: name === "live" ? words.compare.live : name });
  });
  const head = html("tr", {}, html("th"), ...heads);
  const rows = QUANTITIES.map((quantity) => {
    const cells = traces.map(({ answer }) => {
      const textContent =
        answer === undefined ? words.export.noAnswer : measure(words, quantity, answer.read(quantity), units);
      return html("td", { textContent });
    });
    return html("tr", {}, html("th", { scope: "row", textContent: nameOf(words, quantity, false) }), ...cells);
  });
  return html("table", {}, html("thead", {}, head), html("tbody", {}, ...rows));
}
