//! One page of Markdown.

use std::path::{Path, PathBuf};

/// A page and its place in the repository.
pub struct Page {
    path: PathBuf,
    text: String,
}

impl Page {
    pub fn new(path: impl Into<PathBuf>, text: impl Into<String>) -> Self {
        let (path, text) = (path.into(), text.into());
        Self { path, text }
    }

    /// From the root of the repository.
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// Lines outside of fenced code, with their numbers from 1.
    pub fn prose(&self) -> impl Iterator<Item = (usize, &str)> {
        let mut fenced = false;
        (1..).zip(self.text.lines()).filter(move |(_, line)| {
            let fence = line.trim_start().starts_with("```");
            fenced ^= fence;
            !fenced && !fence
        })
    }

    /// Message for a fault in a line.
    pub fn fault(&self, line: usize, what: &str) -> String {
        format!("{}:{line}: {what}", self.path.display())
    }

    /// The names by which links reach its headings, as forges and mdBook form them.
    pub fn anchors(&self) -> Vec<String> {
        let mut anchors: Vec<String> = Vec::new();
        for (_, line) in self.prose() {
            let title = line.trim_start_matches('#');
            if title.len() == line.len() || !title.starts_with(' ') {
                continue;
            }
            let letter = |c: char| match c {
                ' ' => Some('-'),
                c if c.is_alphanumeric() || "-_".contains(c) => Some(c),
                _ => None,
            };
            let anchor: String = title.trim().to_lowercase().chars().filter_map(letter).collect();
            let before = anchors.iter().filter(|known| **known == anchor).count();
            anchors.push(if before == 0 {
                anchor
            } else {
                format!("{anchor}-{before}")
            });
        }
        anchors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_no_prose_and_headings_in_it_have_no_anchors() {
        let page = Page::new("a.md", "# One\n```text\n# two\n```\n## Ca, a/l: `x`\n## One\n#3\n");
        let lines: Vec<usize> = page.prose().map(|(line, _)| line).collect();
        assert_eq!(lines, [1, 5, 6, 7]);
        assert_eq!(page.anchors(), ["one", "ca-al-x", "one-1"]);
    }
}
