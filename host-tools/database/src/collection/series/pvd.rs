//! PVD files: the VTU files of a series by time.

use std::path::{Path, PathBuf};

use roxmltree::Node;

use super::markup::Markup;
use super::{SAME_TIME, malformed};
use crate::DatabaseError;

/// The instants of one configuration.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    /// The PVD file.
    pub path: PathBuf,
    /// Rising in time, at least one.
    pub frames: Vec<Frame>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    pub time: f64,
    /// The parts of the surface in their order.
    pub files: Vec<PathBuf>,
}

/// One line of the list.
struct Entry {
    index: usize,
    time: f64,
    part: u64,
    file: String,
}

impl Series {
    pub fn parse(path: &Path, bytes: &[u8], notes: &mut Vec<String>) -> Result<Self, DatabaseError> {
        let entries = entries(bytes).map_err(|reason| malformed(path, reason))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let largest = entries
            .iter()
            .fold(0.0, |largest: f64, entry| largest.max(entry.time.abs()));
        let mut instants: Vec<Vec<Entry>> = Vec::new();
        for entry in entries {
            match instants.last_mut() {
                Some(instant) if entry.time - instant[0].time <= SAME_TIME * largest => instant.push(entry),
                _ => instants.push(vec![entry]),
            }
        }
        let mut frame = |entries: Vec<Entry>| {
            let parts = parts(entries, path, notes);
            Frame {
                time: parts[0].time,
                files: parts.iter().map(|entry| folder.join(&entry.file)).collect(),
            }
        };
        Ok(Self {
            path: path.to_path_buf(),
            frames: instants.into_iter().map(&mut frame).collect(),
        })
    }
}

/// The parts of an instant. A restart lists an instant again: the later entry counts.
fn parts(mut entries: Vec<Entry>, path: &Path, notes: &mut Vec<String>) -> Vec<Entry> {
    entries.sort_by_key(|entry| (entry.part, entry.index));
    let mut parts: Vec<Entry> = Vec::new();
    for entry in entries {
        match parts.last_mut() {
            Some(known) if known.part == entry.part => {
                if known.file != entry.file {
                    notes.push(format!(
                        "{} lists timestep {} twice: {} counts, {} does not",
                        path.display(),
                        entry.time,
                        entry.file,
                        known.file
                    ));
                }
                *known = entry;
            }
            _ => parts.push(entry),
        }
    }
    parts
}

/// The entries by time.
fn entries(bytes: &[u8]) -> Result<Vec<Entry>, String> {
    let markup = Markup::new(bytes)?;
    let document = markup.document("Collection")?;
    let nodes = document.descendants().filter(|node| node.has_tag_name("DataSet"));
    let nodes: Vec<Node> = nodes.collect();
    let first = nodes.first().ok_or("no DataSet entry, expected one for each instant")?;
    let group = |node: &Node| node.attribute("group").unwrap_or_default().to_owned();
    if let Some(other) = nodes.iter().find(|node| group(node) != group(first)) {
        let groups = [first, other].map(group).join("` and `");
        return Err(format!(
            "entries of the groups `{groups}`, expected those of one capsule alone"
        ));
    }
    let mut entries: Vec<Entry> = nodes
        .iter()
        .enumerate()
        .map(|(index, node)| Entry::new(index, node).map_err(|reason| format!("DataSet entry {}: {reason}", index + 1)))
        .collect::<Result<_, _>>()?;
    entries.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(entries)
}

impl Entry {
    fn new(index: usize, node: &Node) -> Result<Self, String> {
        let attribute = |name: &str| node.attribute(name).ok_or(format!("`{name}` is missing"));
        let time = attribute("timestep")?;
        let number = time.trim().parse().ok().filter(|time: &f64| time.is_finite());
        let part = node.attribute("part").unwrap_or("0");
        Ok(Self {
            index,
            time: number.ok_or_else(|| format!("`timestep` is `{time}`, expected a finite number"))?,
            part: part
                .trim()
                .parse()
                .map_err(|_| format!("`part` is `{part}`, expected a whole number from 0"))?,
            file: attribute("file")?.to_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time and files of each frame.
    type Frames = Vec<(f64, String)>;

    fn read(entries: &str) -> (Result<Frames, String>, Vec<String>) {
        let text = format!("<VTKFile type=\"Collection\" version=\"0.1\"><Collection>{entries}</Collection></VTKFile>");
        let mut notes = Vec::new();
        let series = Series::parse(Path::new("run/c.pvd"), text.as_bytes(), &mut notes);
        let words = |frame: Frame| {
            let files: Vec<String> = frame.files.iter().map(|file| file.display().to_string()).collect();
            (frame.time, files.join(" "))
        };
        let frames = series.map(|series| series.frames.into_iter().map(words).collect());
        (frames.map_err(|error| error.to_string()), notes)
    }

    #[test]
    fn entries_come_by_time_and_parts_in_order() {
        let (frames, notes) = read(
            "<DataSet timestep='1' part='1' file='b1.vtu'/><DataSet timestep='1' part='0' file='b0.vtu'/>\
             <DataSet timestep='0' part='1' file='a1.vtu'/><DataSet timestep=' 0.0 ' file='a0.vtu'/>",
        );
        let expected = [(0.0, "run/a0.vtu run/a1.vtu"), (1.0, "run/b0.vtu run/b1.vtu")];
        assert_eq!(frames.unwrap(), expected.map(|(time, files)| (time, files.to_owned())));
        assert_eq!(notes, [""; 0]);
    }

    #[test]
    fn of_an_instant_that_is_listed_again_the_last_counts_with_a_warning() {
        let again = "<DataSet timestep='0' file='a.vtu'/><DataSet timestep='1' file='b.vtu'/>\
                     <DataSet timestep='2' file='c.vtu'/><DataSet timestep='0.9999999999' file='B.vtu'/>";
        let (frames, notes) = read(again);
        let files: Vec<String> = frames.unwrap().into_iter().map(|(_, files)| files).collect();
        assert_eq!(files, ["run/a.vtu", "run/B.vtu", "run/c.vtu"]);
        assert_eq!(notes.len(), 1, "{notes:?}");
        let words = ["run/c.pvd", "timestep 0.9999999999", "B.vtu counts", "b.vtu does not"];
        assert!(words.iter().all(|word| notes[0].contains(word)), "{notes:?}");
        let (frames, notes) = read(&again.replace("B.vtu", "b.vtu"));
        assert_eq!((frames.unwrap().len(), notes.len()), (3, 0));
    }

    #[test]
    fn what_is_wrong_with_a_list_is_named() {
        for (entries, words) in [
            ("", &["no DataSet"][..]),
            ("<DataSet file='a.vtu'/>", &["entry 1", "`timestep` is missing"]),
            ("<DataSet timestep='0'/>", &["entry 1", "`file` is missing"]),
            (
                "<DataSet timestep='0' file='a.vtu'/><DataSet timestep='nan' file='b.vtu'/>",
                &["entry 2", "`nan`", "finite"],
            ),
            (
                "<DataSet timestep='0' part='x' file='a.vtu'/>",
                &["entry 1", "`part` is `x`"],
            ),
            (
                "<DataSet timestep='0' group='wall' file='a.vtu'/><DataSet timestep='0' group='cell' file='b.vtu'/>",
                &["`wall` and `cell`", "one capsule"],
            ),
        ] {
            let error = read(entries).0.unwrap_err();
            let named = error.starts_with("run/c.pvd: ") && words.iter().all(|word| error.contains(word));
            assert!(named, "{entries}: {error}");
        }
    }
}
