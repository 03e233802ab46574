//! The book: checks of its links, paths, figures, commands and code, then mdBook. A page is Markdown that a forge shows
//! as it is.

mod commands;
mod figures;
mod format;
mod links;
mod page;

use crate::command::{command, output, run};
use crate::{root, setup, target_directory};
use anyhow::{Context, Result, bail};
use page::Page;
use std::path::{Path, PathBuf};

/// Pages outside of `docs`.
const OUTSIDE: [&str; 4] = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "core/capi/README.md"];

#[derive(Default, clap::Args)]
pub struct Options {
    /// Write the stored results into the pages where their figures differ
    #[arg(long)]
    write: bool,
}

/// Checks the pages and builds `target/book`.
pub fn book(options: &Options) -> Result<()> {
    setup::bring(&[setup::PIP, setup::MDBOOK])?;
    if options.write {
        for page in figures::corrected(&pages()?, &root()) {
            println!("{}: figures written", page.path().display());
            std::fs::write(root().join(page.path()), page.text()).context("could not write a page")?;
        }
    }
    let pages = pages()?;
    let mut faults = links::faults(&pages, &root());
    faults.extend(figures::faults(&pages, &root()));
    faults.extend(commands::faults(&pages)?);
    if !faults.is_empty() {
        bail!("{} faults:\n  {}", faults.len(), faults.join("\n  "));
    }
    format::check()?;
    run_code(&pages)?;
    let folder = target_directory().join("book");
    run(command("mdbook build docs --dest-dir").arg(&folder))?;
    println!("{} pages: {}", pages.len(), folder.join("index.html").display());
    Ok(())
}

/// All pages, with paths from the root of the repository.
fn pages() -> Result<Vec<Page>> {
    let mut paths: Vec<PathBuf> = OUTSIDE.iter().map(PathBuf::from).collect();
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).with_context(|| folder.display().to_string())? {
            let path = folder.join(entry?.file_name());
            if root().join(&path).is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                paths.push(path);
            }
        }
    }
    paths.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(root().join(&path)).with_context(|| path.display().to_string())?;
        Ok(Page::new(path, text))
    };
    paths.into_iter().map(read).collect()
}

/// Compiles and runs the Rust code of the pages, in the root of the repository as a reader would.
fn run_code(pages: &[Page]) -> Result<()> {
    run(&mut command("cargo build --quiet --package capsule-rom-core"))?;
    let built = target_directory().join("debug");
    let supports = output(&mut command("rustdoc --help"))?.contains("--test-run-directory");
    if !supports {
        bail!("rustdoc is too old: it has no --test-run-directory");
    }
    for page in pages.iter().filter(|page| page.text().contains("\n```rust\n")) {
        run(command("rustdoc --edition 2024 --test --test-run-directory .")
            .arg("--extern")
            .arg(format!("capsule_core={}", built.join("libcapsule_core.rlib").display()))
            .arg("-L")
            .arg(format!("dependency={}", built.join("deps").display()))
            .arg(page.path()))?;
    }
    Ok(())
}

/// A path without `.` and `..`, as a link from `page` means it.
fn resolve(page: &Path, target: &str) -> PathBuf {
    let mut path = page.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                path.pop();
            }
            part => path.push(part),
        }
    }
    path
}
