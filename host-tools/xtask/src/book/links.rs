//! Links between pages, their anchors, paths of the repository in code spans, the table of contents, and line lengths.

use super::page::Page;
use super::resolve;
use std::path::Path;

/// Folders of the repository: a code span that starts with one of them and a slash names a file or a folder.
const ROOMS: [&str; 6] = ["core/", "wasm/", "host-tools/", "tests/", "models/", "docs/"];
/// Folders that a build makes and no clone holds.
const BUILT: [&str; 1] = ["wasm/explorer/dist/"];
/// The greatest length of a line of prose; tables, comments, indented code and links may be longer.
const COLUMNS: usize = 120;

/// Faults of the pages of a repository.
pub fn faults(pages: &[Page], root: &Path) -> Vec<String> {
    let mut faults = Vec::new();
    for page in pages {
        for (number, line) in page.prose() {
            let (plain, spans) = without_code(line);
            for target in targets(&plain) {
                faults.extend(broken(page, target, pages, root).map(|what| page.fault(number, &what)));
            }
            for path in spans.iter().filter_map(|span| path_of(span)) {
                if !BUILT.contains(&path) && !root.join(path).exists() {
                    faults.push(page.fault(number, &format!("there is no `{path}`")));
                }
            }
            let excused = ["|", "<!--", "    "].iter().any(|start| line.starts_with(start)) || line.contains("](");
            if line.chars().count() > COLUMNS && !excused {
                faults.push(page.fault(number, &format!("more than {COLUMNS} columns")));
            }
        }
    }
    faults.extend(unlisted(pages));
    faults
}

/// Pages of `docs` that the table of contents does not name.
fn unlisted(pages: &[Page]) -> Vec<String> {
    let summary = Path::new("docs/SUMMARY.md");
    let Some(contents) = pages.iter().find(|page| page.path() == summary) else {
        return vec!["docs/SUMMARY.md is missing".to_owned()];
    };
    let listed: Vec<_> = contents
        .prose()
        .flat_map(|(_, line)| targets(line).map(|target| resolve(summary, target)).collect::<Vec<_>>())
        .collect();
    pages
        .iter()
        .map(Page::path)
        .filter(|path| path.starts_with("docs") && *path != summary && !listed.iter().any(|listed| listed == path))
        .map(|path| format!("{}: docs/SUMMARY.md does not name it", path.display()))
        .collect()
}

/// The fault of a link.
fn broken(page: &Page, target: &str, pages: &[Page], root: &Path) -> Option<String> {
    if ["http://", "https://", "mailto:"]
        .iter()
        .any(|scheme| target.starts_with(scheme))
    {
        return None;
    }
    let (file, anchor) = target
        .split_once('#')
        .map_or((target, None), |(file, anchor)| (file, Some(anchor)));
    let path = if file.is_empty() {
        page.path().to_path_buf()
    } else {
        resolve(page.path(), file)
    };
    if page.path().starts_with("docs") && !path.starts_with("docs") {
        return Some(format!("the book does not hold `{target}`: name it as code"));
    }
    if !root.join(&path).exists() {
        return Some(format!("there is no `{target}`"));
    }
    let anchor = anchor?;
    let anchors = pages.iter().find(|page| page.path() == path)?.anchors();
    let known = anchors.iter().any(|known| known == anchor);
    (!known).then(|| format!("`{target}`: {} has no such heading", path.display()))
}

/// A line with its code spans blanked out, and these.
fn without_code(line: &str) -> (String, Vec<&str>) {
    let (mut plain, mut spans) = (String::new(), Vec::new());
    for (index, part) in line.split('`').enumerate() {
        if index % 2 == 0 {
            plain.push_str(part);
        } else {
            plain.push_str("code");
            spans.push(part);
        }
    }
    (plain, spans)
}

/// The targets of inline links and pictures.
fn targets(line: &str) -> impl Iterator<Item = &str> {
    line.match_indices("](").filter_map(|(start, mark)| {
        let target = &line[start + mark.len()..];
        target.split_once(')').map(|(target, _)| target)
    })
}

/// The path that a code span names.
fn path_of(span: &str) -> Option<&str> {
    let is_path = ROOMS.iter().any(|room| span.starts_with(room));
    let plain = |c: char| c.is_alphanumeric() || "/-_.".contains(c);
    (is_path && span.chars().all(plain)).then_some(span)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The faults of these pages in the real repository.
    fn found(pages: &[(&str, &str)]) -> Vec<String> {
        let pages: Vec<Page> = pages.iter().map(|(path, text)| Page::new(*path, *text)).collect();
        faults(&pages, &crate::root())
    }

    const SUMMARY: (&str, &str) = ("docs/SUMMARY.md", "- [Contents](README.md)\n");

    #[test]
    fn links_and_paths_that_exist_are_right() {
        let text = "# A title\n[x](#a-title), [y](SUMMARY.md), [z](https://example.org/a), `core/src/lib.rs`, `core/dsp/`, `wasm/explorer/dist/`,\n\
                    ```sh\n[not](a/link.md)\n```\n`[nor](this.md)`, `tests/*.c`\n";
        assert_eq!(found(&[SUMMARY, ("docs/README.md", text)]), [""; 0]);
    }

    #[test]
    fn what_is_not_there_is_told_with_its_line() {
        let text = "# A\n[x](nothing.md) ![y](no.png)\n[z](#b)\n`core/nothing.rs`\n[code](../core/src/lib.rs)\n";
        let told = [
            "docs/README.md:2: there is no `nothing.md`",
            "docs/README.md:2: there is no `no.png`",
            "docs/README.md:3: `#b`: docs/README.md has no such heading",
            "docs/README.md:4: there is no `core/nothing.rs`",
            "docs/README.md:5: the book does not hold `../core/src/lib.rs`: name it as code",
        ];
        assert_eq!(found(&[SUMMARY, ("docs/README.md", text)]), told);
    }

    #[test]
    fn a_page_must_be_in_the_contents_and_its_lines_short() {
        let long = "x".repeat(121);
        let told = found(&[SUMMARY, ("docs/README.md", &long), ("docs/reference/glossary.md", "")]);
        let expected = [
            "docs/README.md:1: more than 120 columns",
            "docs/reference/glossary.md: docs/SUMMARY.md does not name it",
        ];
        assert_eq!(told, expected);
    }
}
