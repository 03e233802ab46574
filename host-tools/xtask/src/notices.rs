//! The notices that the licences of other people's code ask for: every crate that is linked into an artefact, with its
//! licence and the texts that come with it.

use crate::command::{command, output};
use crate::root;
use anyhow::{Context, Result, anyhow};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// The notices' file in every artefact.
pub const FILE: &str = "THIRD-PARTY.txt";

const STANDARD_LIBRARY: &str = "Rust standard library";

/// A crate that is linked.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Crate {
    name: String,
    version: String,
    /// An SPDX expression.
    licence: String,
    authors: String,
    folder: PathBuf,
}

/// The notices of the crates that are linked into `package` for a target.
pub fn of(package: &str, target: &str) -> Result<String> {
    let mut text = format!("Other people's software in {package}, for {target}.\n");
    let rust = output(&mut command("rustc --version"))?;
    let terms = fs::read_to_string(root().join("LICENSE-MIT")).context("LICENSE-MIT")?;
    let (_, terms) = terms
        .split_once("\n\nPermission")
        .context("LICENSE-MIT grants no permission")?;
    write!(
        text,
        "\n## {STANDARD_LIBRARY} - {} (MIT OR Apache-2.0)\n\n\
         Copyright (c) The Rust Project Contributors\n\nPermission{terms}",
        rust.trim()
    )?;
    // Crates with the same texts share them.
    let mut texts: BTreeMap<String, Vec<Crate>> = BTreeMap::new();
    for linked in linked(package, target)? {
        texts.entry(linked.texts()?).or_default().push(linked);
    }
    let mut groups: Vec<(Vec<Crate>, String)> = texts.into_iter().map(|(text, crates)| (crates, text)).collect();
    groups.sort();
    for (crates, terms) in groups {
        text.push('\n');
        for Crate {
            name, version, licence, ..
        } in crates
        {
            writeln!(text, "## {name} - {version} ({licence})")?;
        }
        writeln!(text, "\n{terms}")?;
    }
    Ok(text)
}

/// The paths in a folder.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    fs::read_dir(folder)
        .with_context(|| folder.display().to_string())?
        .map(|entry| Ok(entry?.path()))
        .collect()
}

impl Crate {
    /// The licence texts in the crate's folder. Where one of several licences may be chosen, MIT is, else Apache-2.0.
    fn texts(&self) -> Result<String> {
        let mut files = entries(&self.folder)?;
        files.retain(|file| {
            let name = upper_case_name(file);
            ["LICENSE", "LICENCE", "COPYING", "NOTICE"]
                .iter()
                .any(|start| name.starts_with(start))
        });
        // Some keep theirs in a folder LICENSES.
        let (folders, mut files): (Vec<_>, Vec<_>) = files.into_iter().partition(|file| file.is_dir());
        for folder in folders {
            files.extend(entries(&folder)?);
        }
        files.sort();
        if !self.licence.contains(" AND ") {
            for chosen in ["MIT", "APACHE"] {
                if files.iter().any(|file| upper_case_name(file).contains(chosen)) {
                    files.retain(|file| upper_case_name(file).contains(chosen));
                }
            }
        }
        let mut texts = Vec::new();
        for file in &files {
            let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
            texts.push(text.replace("\r\n", "\n").trim().to_owned());
        }
        if texts.is_empty() {
            texts.push(format!(
                "Copyright (c) {}. The package comes without a licence text: see https://spdx.org/licenses/",
                self.authors
            ));
        }
        Ok(texts.join("\n\n"))
    }
}

fn upper_case_name(file: &Path) -> String {
    file.file_name()
        .map_or(String::new(), |name| name.to_string_lossy().to_uppercase())
}

/// The crates of others that `package` links for a target: all normal dependencies, without those of procedural macros,
/// which run in the compiler.
fn linked(package: &str, target: &str) -> Result<BTreeSet<Crate>> {
    let metadata: Value = serde_json::from_str(&output(&mut command(&format!(
        "cargo metadata --format-version 1 --locked --filter-platform {target}"
    )))?)?;
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let by_id = |values: &Value| -> BTreeMap<String, Value> {
        list(values)
            .into_iter()
            .map(|value| (text(&value["id"]), value))
            .collect()
    };
    let (packages, nodes) = (by_id(&metadata["packages"]), by_id(&metadata["resolve"]["nodes"]));
    let start = packages.iter().find(|(_, value)| value["name"] == package);
    let (start, _) = start.ok_or_else(|| anyhow!("the workspace has no package {package}"))?;

    let mut linked = BTreeSet::new();
    let mut seen = BTreeSet::from([start.clone()]);
    let mut open = vec![start.clone()];
    while let Some(id) = open.pop() {
        let (package, node) = (&packages[&id], &nodes[&id]);
        if !package["source"].is_null() {
            let manifest = PathBuf::from(text(&package["manifest_path"]));
            let authors: Vec<String> = list(&package["authors"]).iter().map(text).collect();
            linked.insert(Crate {
                name: text(&package["name"]),
                version: text(&package["version"]),
                licence: text(&package["license"]),
                authors: authors.join(", "),
                folder: manifest.parent().context("a manifest without a folder")?.to_path_buf(),
            });
        }
        for dependency in list(&node["deps"]) {
            let id = text(&dependency["pkg"]);
            let is_normal = list(&dependency["dep_kinds"]).iter().any(|kind| kind["kind"].is_null());
            let is_macro = list(&packages[&id]["targets"])
                .iter()
                .any(|target| list(&target["kind"]).contains(&"proc-macro".into()));
            if is_normal && !is_macro && seen.insert(id.clone()) {
                open.push(id);
            }
        }
    }
    Ok(linked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::targets;

    /// Cargo's own list of the linked crates.
    fn tree(package: &str, target: &str) -> BTreeSet<String> {
        let tree = output(&mut command(&format!(
            "cargo tree --locked --package {package} --edges normal,no-proc-macro --target {target} --prefix none"
        )));
        let tree = tree.unwrap();
        let of_others = tree
            .lines()
            .filter(|line| !line.contains(&*root().to_string_lossy()))
            .map(|line| {
                let mut words = line.split_whitespace();
                let (name, version) = (words.next().unwrap(), words.next().unwrap());
                format!("## {name} - {} (", version.trim_start_matches('v'))
            });
        of_others.collect()
    }

    #[test]
    fn every_linked_crate_is_named_with_a_text() {
        let archives = targets::ARCHIVES.iter().map(|archive| ("capsule-capi", archive.target));
        let modules = ["capsule-wasm", "capsule-identify-wasm"].map(|package| (package, targets::WASM));
        for (package, target) in archives.chain(modules) {
            let (tree, notices) = (tree(package, target), of(package, target).unwrap());
            assert!(tree.len() > 8, "{tree:?}");
            for heading in &tree {
                assert!(notices.contains(heading), "{heading} of {package} for {target}");
            }
            for part in [
                STANDARD_LIBRARY,
                "Copyright (c) 2017 Jorge Aparicio",
                "(MIT OR Apache-2.0)",
            ] {
                assert!(notices.contains(part), "{part} of {package} for {target}");
            }
            assert!(!notices.contains("## capsule"), "our own crates have other files");
        }
    }
}
