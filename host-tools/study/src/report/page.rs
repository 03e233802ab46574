//! The page as text.

use std::fmt::Write;

use capsule_core::Model;

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
    let title = escape(model.title());
    let mut body = String::new();
    let _ = write!(
        body,
        "<header><h1>{title}: accuracy, speed and stability</h1><p>Model {:08x}, {} nodes. Lengths are in l, half the channel's side; velocities in the mean \
         velocity V; times in l/V; a is the capsule's radius. The numbers behind each figure are in the CSV file that is named \
         with it.</p><nav aria-label=\"Contents\"><ul>",
        model.digest(),
        model.mesh().nodes()
    );
    for (index, section) in sections.iter().enumerate() {
        let _ = write!(body, "<li><a href=\"#s{index}\">{}</a></li>", escape(&section.title));
    }
    body.push_str("</ul></nav></header><main>");
    for (index, section) in sections.iter().enumerate() {
        let _ = write!(
            body,
            "<section id=\"s{index}\" aria-labelledby=\"h{index}\"><h2 id=\"h{index}\">{}</h2><p>{}</p>",
            escape(&section.title),
            escape(&section.text)
        );
        body.push_str("<div class=\"figures\">");
        section.figures.iter().for_each(|drawing| figure(&mut body, drawing));
        body.push_str("</div>");
        section.tables.iter().for_each(|entries| table(&mut body, entries));
        body.push_str("</section>");
    }
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width,initial-scale=1\"><title>{title}</title><style>{STYLE}</style></head><body>{body}</main></body></html>\n"
    )
}

fn figure(body: &mut String, drawing: &Drawing) {
    let caption = escape(&drawing.caption);
    let _ = write!(
        body,
        "<figure>{}<figcaption>{caption} (<a href=\"{1}\">{1}</a>)</figcaption></figure>",
        coloured(&drawing.svg, &caption),
        escape(&drawing.data)
    );
}

fn table(body: &mut String, table: &Table) {
    body.push_str("<div class=\"table\" tabindex=\"0\"><table><thead><tr>");
    for (index, cell) in table.heading.iter().enumerate() {
        let numbers = table
            .rows
            .iter()
            .any(|row| row.get(index).is_some_and(|cell| number(cell)));
        let _ = write!(body, "<th scope=\"col\"{}>{}</th>", class(numbers), escape(cell));
    }
    body.push_str("</tr></thead><tbody>");
    for row in &table.rows {
        body.push_str("<tr>");
        for cell in row {
            let _ = write!(body, "<td{}>{}</td>", class(number(cell)), escape(cell));
        }
        body.push_str("</tr>");
    }
    let _ = write!(
        body,
        "</tbody></table><p><a href=\"{0}\">{0}</a></p></div>",
        escape(&table.data)
    );
}

fn number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok()
}

fn class(numbers: bool) -> &'static str {
    if numbers { " class=\"number\"" } else { "" }
}

/// A drawing with a text for those who do not see it, in the page's colours.
fn coloured(svg: &str, alternative: &str) -> String {
    let svg = svg
        .replace("#FFFFFF", "var(--card)")
        .replace("#000000", "var(--ink)")
        .replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{alternative}\" "), 1);
    // Presentation attributes do not know variables; styles do.
    ["fill", "stroke"].iter().fold(svg, |svg, name| {
        ["card", "ink"].iter().fold(svg, |svg, variable| {
            svg.replace(
                &format!("{name}=\"var(--{variable})\""),
                &format!("style=\"{name}:var(--{variable})\""),
            )
        })
    })
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
