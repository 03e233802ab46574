//! Commands in the documents and in this program name packages that exist.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The texts of the files in the index that match a pattern.
fn texts(pattern: &str) -> Vec<(String, String)> {
    let output = Command::new("git")
        .args(["ls-files", pattern])
        .current_dir(root())
        .output()
        .unwrap();
    let files = String::from_utf8(output.stdout).unwrap();
    let read = |file: &str| (file.to_owned(), std::fs::read_to_string(root().join(file)).unwrap());
    files.lines().map(read).collect()
}

#[test]
fn packages_that_commands_name_exist() {
    let manifests = texts("*Cargo.toml");
    let lines = manifests.iter().flat_map(|(_, text)| text.lines());
    let names: BTreeSet<&str> = lines
        .filter_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'))
        .collect();
    let mut asked = 0;
    for (file, text) in texts("*.md").into_iter().chain(texts("host-tools/xtask/src/*.rs")) {
        let words: Vec<&str> = text.split_whitespace().collect();
        for pair in words.windows(2) {
            let name = pair[1].trim_end_matches(|c: char| !c.is_ascii_alphanumeric());
            if ["-p", "--package"].contains(&pair[0].trim_start_matches('`')) && name.starts_with("capsule") {
                assert!(names.contains(name), "{file} names the package {name}");
                asked += 1;
            }
        }
    }
    assert!(asked > 10, "{asked} commands with a package");
}
