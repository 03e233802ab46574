//! The page as HTML.

use capsule_core::Model;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::sheet::{Drawing, Section, Table};

const STYLE: &str = "\
:root{color-scheme:light dark;--paper:#ffffff;--ink:#16202a;--soft:#5a6672;--line:#d5dbe1;--card:#f6f8fa}
@media(prefers-color-scheme:dark){:root{--paper:#12171d;--ink:#e6ebf0;--soft:#9aa7b4;--line:#2e3843;--card:#181f27}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,sans-serif}
main,header{max-width:76rem;margin:auto;padding:0 1rem}
h1{font-size:1.7rem;line-height:1.25;margin:1.5rem 0 .5rem}
h2{font-size:1.25rem;margin:2.5rem 0 .5rem;padding-top:.75rem;border-top:1px solid var(--line)}
p{max-width:50rem}
nav ul{columns:18rem;padding-left:1.1rem}
a{color:inherit}
.figures{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,25rem),1fr));gap:1rem}
figure{margin:0;padding:.5rem;background:var(--card);border:1px solid var(--line);border-radius:.5rem}
figure svg{display:block;width:100%;height:auto}
figcaption{font-size:.875rem;color:var(--soft)}
.table{overflow-x:auto;margin:1rem 0}
table{border-collapse:collapse;font-size:.875rem}
th,td{padding:.25rem .6rem;border-bottom:1px solid var(--line);text-align:left;vertical-align:top}
th{white-space:nowrap}
.number{text-align:right;font-variant-numeric:tabular-nums}";

/// One page with everything in it.
pub(super) fn page(model: &Model, sections: &[Section]) -> String {
    let title = model.title();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width,initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (title) ": accuracy, speed and stability" }
                    p {
                        "Model " (format!("{:08x}", model.digest())) ", " (model.mesh().nodes()) " nodes. "
                        "Lengths are in l, half the channel's side; velocities in the mean velocity V; times in l/V; a \
                         is "
                        "the capsule's radius. The numbers behind each figure are in the CSV file that is named with \
                         it."
                    }
                    nav aria-label="Contents" {
                        ul {
                            @for (index, section) in sections.iter().enumerate() {
                                li { a href=(format!("#s{index}")) { (section.title) } }
                            }
                        }
                    }
                }
                main {
                    @for (index, section) in sections.iter().enumerate() {
                        (part(index, section))
                    }
                }
            }
        }
    };
    page.into_string() + "\n"
}

fn part(index: usize, section: &Section) -> Markup {
    let heading = format!("h{index}");
    html! {
        section id=(format!("s{index}")) aria-labelledby=(heading) {
            h2 id=(heading) { (section.title) }
            p { (section.text) }
            div class="figures" { @for drawing in &section.figures { (figure(drawing)) } }
            @for entries in &section.tables { (table(entries)) }
        }
    }
}

fn figure(drawing: &Drawing) -> Markup {
    html! {
        figure {
            (PreEscaped(coloured(&drawing.svg, &drawing.caption)))
            figcaption { (drawing.caption) " (" a href=(drawing.data) { (drawing.data) } ")" }
        }
    }
}

fn table(table: &Table) -> Markup {
    let numbers = |index: usize| {
        let mut cells = table.rows.iter().filter_map(|row| row.get(index));
        cells.any(|cell| number(cell))
    };
    html! {
        div class="table" tabindex="0" {
            table {
                thead {
                    tr {
                        @for (index, cell) in table.heading.iter().enumerate() {
                            th scope="col" class=[class(numbers(index))] { (cell) }
                        }
                    }
                }
                tbody {
                    @for row in &table.rows {
                        tr { @for cell in row { td class=[class(number(cell))] { (cell) } } }
                    }
                }
            }
            p { a href=(table.data) { (table.data) } }
        }
    }
}

fn number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok()
}

fn class(numbers: bool) -> Option<&'static str> {
    numbers.then_some("number")
}

/// A drawing in the page's colours, with an alternative text.
fn coloured(svg: &str, alternative: &str) -> String {
    let alternative = html! { (alternative) }.into_string();
    let svg = svg
        .replace("#FFFFFF", "var(--card)")
        .replace("#000000", "var(--ink)")
        .replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{alternative}\" "), 1);
    // CSS variables work in style attributes, not in presentation attributes.
    ["fill", "stroke"].iter().fold(svg, |svg, name| {
        ["card", "ink"].iter().fold(svg, |svg, variable| {
            svg.replace(
                &format!("{name}=\"var(--{variable})\""),
                &format!("style=\"{name}:var(--{variable})\""),
            )
        })
    })
}
