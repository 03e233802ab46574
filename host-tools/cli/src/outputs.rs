//! Outputs of a command: checked before anything is computed, and written all together or not at all.

use anyhow::{Context, Result, bail, ensure};
use capsule_database::{Staging, followed};
use capsule_plot::Format;
use same_file::Handle;
use std::ffi::OsStr;
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// Inputs and outputs of a command. Name all of them, then call [`Outputs::checked`].
#[derive(Default)]
pub struct Outputs {
    inputs: Vec<Named>,
    outputs: Vec<(Named, Kind)>,
    staging: Staging,
}

/// A path, and the option that names it.
struct Named {
    option: &'static str,
    path: PathBuf,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    File,
    /// A file whose extension selects its format.
    Figure,
    Folder,
}

impl Outputs {
    /// A file or folder that is read: neither it nor a file in it may be written.
    pub fn reads<'p>(mut self, option: &'static str, path: impl Into<Option<&'p Path>>) -> Self {
        self.inputs.extend(Named::new(option, path.into()));
        self
    }

    /// A file that is written.
    pub fn file<'p>(self, option: &'static str, path: impl Into<Option<&'p Path>>) -> Self {
        self.writes(option, path.into(), Kind::File)
    }

    /// A figure that is written, as SVG or PNG.
    pub fn figure<'p>(self, option: &'static str, path: impl Into<Option<&'p Path>>) -> Self {
        self.writes(option, path.into(), Kind::Figure)
    }

    /// A folder that files are written into.
    pub fn folder<'p>(self, option: &'static str, path: impl Into<Option<&'p Path>>) -> Self {
        self.writes(option, path.into(), Kind::Folder)
    }

    fn writes(mut self, option: &'static str, path: Option<&Path>, kind: Kind) -> Self {
        self.outputs
            .extend(Named::new(option, path).map(|output| (output, kind)));
        self
    }

    /// Checks that all outputs can be written, and that each is neither an input nor another output.
    pub fn checked(self) -> Result<Self> {
        for (i, (output, kind)) in self.outputs.iter().enumerate() {
            let mut others = self.outputs[..i].iter().map(|(other, _)| other);
            if let Some(other) = others.find(|other| same(&output.path, &other.path)) {
                bail!("{output} and {other} are the same: name two paths");
            }
            if let Some(input) = self.inputs.iter().find(|input| input.holds(&output.path)) {
                bail!("{output} would overwrite what {input} reads: name another path");
            }
            match kind {
                Kind::Folder => check_folder(&output.path),
                Kind::File => self.check_file(&output.path),
                Kind::Figure => Format::of(&output.path)
                    .map_err(Into::into)
                    .and_then(|_| self.check_file(&output.path)),
            }
            .with_context(|| output.to_string())?;
        }
        Ok(self)
    }

    fn check_file(&self, path: &Path) -> Result<()> {
        let text = path.to_string_lossy();
        ensure!(
            path.file_name().is_some() && !text.ends_with(std::path::is_separator) && !path.is_dir(),
            "it is a folder, and a file is written: name a file"
        );
        if path.exists() && !path.is_file() {
            // A device or a pipe.
            return Ok(());
        }
        if path.exists() {
            let opened = OpenOptions::new().append(true).open(path);
            opened.context("the file that is there cannot be written")?;
            let printed = Handle::stdout().ok().is_some_and(|stdout| handle(path) == Some(stdout));
            ensure!(!printed, "the standard output goes there: name another file");
        }
        let folder = folder_of(path);
        let own = |(output, kind): &(Named, Kind)| *kind == Kind::Folder && folder.starts_with(&output.path);
        if !folder.exists() && self.outputs.iter().any(own) {
            return Ok(());
        }
        ensure!(folder.is_dir(), "there is no folder {}", folder.display());
        check_writable(folder)
    }

    /// Stages the file for `path`: `write` receives the temporary path.
    pub fn write<E>(&mut self, path: &Path, write: impl FnOnce(&Path) -> Result<(), E>) -> Result<()>
    where
        Result<(), E>: Context<(), E>,
    {
        let context = || format!("could not write {}", path.display());
        let place = self.staging.place(path).with_context(context)?;
        write(&place).with_context(context)
    }

    /// Stages files for the folder at `path`: `write` receives the temporary folder.
    pub fn write_into(&mut self, path: &Path, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        self.write(path, |place| {
            std::fs::create_dir(place)?;
            write(place)
        })
    }

    /// Moves all staged files to their places.
    pub fn finish(self) -> Result<()> {
        let mut targets = self.staging.targets()?;
        for target in &targets {
            if let Some(input) = self.inputs.iter().find(|input| input.holds(target)) {
                bail!(
                    "{} would overwrite what {input} reads: name another path",
                    target.display()
                );
            }
        }
        targets.sort();
        if let Some(twice) = targets.windows(2).find(|pair| pair[0] == pair[1]) {
            bail!("two outputs are named {}: name two paths", twice[0].display());
        }
        Ok(self.staging.finish()?)
    }
}

impl Named {
    fn new(option: &'static str, path: Option<&Path>) -> Option<Self> {
        let path = path?.to_path_buf();
        Some(Self { option, path })
    }

    /// Whether `path` is this, or a file in it other than a model.
    fn holds(&self, path: &Path) -> bool {
        if same(path, &self.path) {
            return true;
        }
        let Some(handle) = handle(path).filter(|_| path.is_file()) else {
            return false;
        };
        let content = WalkDir::new(&self.path).min_depth(1).follow_links(true).into_iter();
        content
            .filter_map(Result::ok)
            .filter(|entry| entry.file_type().is_file() && entry.path().extension() != Some(OsStr::new("crom")))
            .any(|entry| Handle::from_path(entry.path()).is_ok_and(|other| other == handle))
    }
}

impl std::fmt::Display for Named {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.option, self.path.display())
    }
}

/// Whether two paths name the same file or folder, links resolved; the paths need not exist.
fn same(a: &Path, b: &Path) -> bool {
    match (handle(a), handle(b)) {
        (Some(a), Some(b)) => a == b,
        _ => by_case(followed(a)) == by_case(followed(b)),
    }
}

/// Lower case on systems whose file names ignore case.
fn by_case(path: PathBuf) -> PathBuf {
    if cfg!(any(windows, target_os = "macos")) {
        return path.to_string_lossy().to_lowercase().into();
    }
    path
}

/// A file or folder that is there; a pipe is not opened, since that may wait for its other end.
fn handle(path: &Path) -> Option<Handle> {
    let there = path.is_file() || path.is_dir();
    there.then(|| Handle::from_path(path).ok()).flatten()
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn check_folder(path: &Path) -> Result<()> {
    let there = path.ancestors().find(|folder| folder.exists());
    let there = there.unwrap_or(Path::new("."));
    ensure!(
        there.is_dir(),
        "{} is a file, and a folder is needed: name another folder",
        there.display()
    );
    check_writable(there)
}

/// Creates a hidden file in the folder and removes it.
fn check_writable(folder: &Path) -> Result<()> {
    match tempfile::Builder::new().prefix(".tmp").tempfile_in(folder) {
        Ok(_) => Ok(()),
        Err(error) => bail!("cannot write into the folder {}: {}", folder.display(), error.kind()),
    }
}
