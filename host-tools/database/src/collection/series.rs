//! Collections as folders of VTU series.
//!
//! The folder holds `parameters.csv`: a heading `series,NAME,...`, then a row for each configuration with the path of its
//! PVD file, relative to the folder, and its parameters. A PVD file lists VTU files by time; those of `capsule-rom fom run
//! --out` and `capsule-rom predict --vtu` are of this kind. All series are of one mesh, of flat or quadratic triangles;
//! of their instants those count that all have, and point data `velocity` where all have it. Arrays are inline, as text or
//! base64, plain or compressed by zlib.

use std::io::Read;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node};

use super::{Collection, MAX_PARAMETERS, check_times, elements};
use crate::DatabaseError;
use crate::error::finite;
use crate::vtu::{QUADRATIC_TRIANGLE, TRIANGLE};

/// Instants of two series closer than this share of the last one are the same.
const SAME_TIME: f64 = 1e-6;

/// Reads the series of a folder.
///
/// # Errors
/// What is missing or malformed, with its file.
pub(crate) fn read(folder: &Path) -> Result<Collection, DatabaseError> {
    let table = Table::read(&folder.join("parameters.csv"))?;
    let lists = table.series.iter().map(|name| list(&folder.join(name)));
    let lists: Vec<Vec<(f64, String)>> = lists.collect::<Result<_, _>>()?;
    let times = common(&lists);
    check_times(&times)?;
    let mut triangles = None;
    let (mut positions, mut velocities) = (Vec::new(), Vec::new());
    for (name, list) in table.series.iter().zip(&lists) {
        let place = folder.join(name);
        let place = place.parent().unwrap_or(folder);
        let chosen = times
            .iter()
            .filter_map(|t| list.iter().find(|(time, _)| same(*time, *t, &times)));
        let snapshots = chosen.map(|(_, file)| Snapshot::read(&place.join(file)));
        let snapshots: Vec<Snapshot> = snapshots.collect::<Result<_, _>>()?;
        let mesh = triangles.get_or_insert_with(|| (snapshots[0].elements.clone(), snapshots[0].positions.len()));
        if let Some(other) = snapshots
            .iter()
            .position(|s| (&s.elements, s.positions.len()) != (&mesh.0, mesh.1))
        {
            let reason = format!("snapshot {other} has another mesh than the first of all series; expected the same");
            let path = folder.join(name);
            return Err(DatabaseError::Malformed { path, reason });
        }
        let moving: Option<Vec<_>> = snapshots.iter().map(|s| s.velocities.clone()).collect();
        velocities.extend(moving);
        positions.push(snapshots.into_iter().map(|s| s.positions).collect());
    }
    if velocities.len() < positions.len() {
        velocities.clear();
    }
    Collection::new(Collection {
        parameter_names: table.names,
        length_unit: None,
        time_unit: None,
        parameters: table.parameters,
        times,
        elements: triangles.map(|(elements, _)| elements).unwrap_or_default(),
        positions,
        velocities,
    })
}

/// The table of parameters.
struct Table {
    names: Vec<String>,
    series: Vec<String>,
    parameters: Vec<Vec<f64>>,
}

impl Table {
    fn read(path: &Path) -> Result<Self, DatabaseError> {
        let malformed = |reason: String| DatabaseError::Malformed {
            path: path.to_path_buf(),
            reason,
        };
        let wrong = |error: csv::Error| match error.into_kind() {
            csv::ErrorKind::Io(source) => DatabaseError::io("read", path)(source),
            other => malformed(format!("{other:?}")),
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(wrong)?;
        let heading: Vec<String> = reader.headers().map_err(wrong)?.iter().map(str::to_owned).collect();
        let names = match heading.split_first() {
            Some((first, names)) if first == "series" && (1..=MAX_PARAMETERS).contains(&names.len()) => names.to_vec(),
            _ => {
                let found = heading.join(",");
                return Err(malformed(format!(
                    "heading `{found}`, expected `series,` and one to four parameters"
                )));
            }
        };
        let (mut series, mut parameters) = (Vec::new(), Vec::new());
        for (row, record) in reader.records().enumerate() {
            let record = record.map_err(wrong)?;
            series.push(record.get(0).unwrap_or_default().to_owned());
            let number = |(text, name): (&str, &String)| {
                let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
                value.ok_or_else(|| malformed(format!("row {row}: `{name}` is `{text}`, expected a finite number")))
            };
            parameters.push(
                record
                    .iter()
                    .skip(1)
                    .zip(&names)
                    .map(number)
                    .collect::<Result<_, _>>()?,
            );
        }
        if series.is_empty() {
            return Err(malformed("no row, expected one for each configuration".to_owned()));
        }
        Ok(Self {
            names,
            series,
            parameters,
        })
    }
}

fn same(a: f64, b: f64, times: &[f64]) -> bool {
    (a - b).abs() <= SAME_TIME * times.last().copied().unwrap_or(0.0).abs()
}

/// The instants of the first series that all have.
fn common(lists: &[Vec<(f64, String)>]) -> Vec<f64> {
    let times: Vec<f64> = lists.first().into_iter().flatten().map(|(time, _)| *time).collect();
    let everywhere = |t: &f64| {
        lists
            .iter()
            .all(|list| list.iter().any(|(time, _)| same(*time, *t, &times)))
    };
    times.iter().copied().filter(everywhere).collect()
}

/// Times and files of a PVD file.
fn list(path: &Path) -> Result<Vec<(f64, String)>, DatabaseError> {
    let text = std::fs::read_to_string(path).map_err(DatabaseError::io("read", path))?;
    let malformed = |reason: String| DatabaseError::Malformed {
        path: path.to_path_buf(),
        reason,
    };
    let document = Document::parse(&text).map_err(|error| malformed(error.to_string()))?;
    let entry = |node: Node| {
        let time = node.attribute("timestep").and_then(|time| time.parse().ok());
        Some((time?, node.attribute("file")?.to_owned()))
    };
    let entries = document.descendants().filter(|node| node.has_tag_name("DataSet"));
    let list: Option<Vec<_>> = entries.map(entry).collect();
    let list = list.filter(|list| !list.is_empty());
    list.ok_or_else(|| malformed("expected DataSet entries, each with `timestep` and `file`".to_owned()))
}

/// One VTU file.
struct Snapshot {
    positions: Vec<[f64; 3]>,
    velocities: Option<Vec<[f64; 3]>>,
    elements: Vec<[u32; 6]>,
}

impl Snapshot {
    fn read(path: &Path) -> Result<Self, DatabaseError> {
        let text = std::fs::read_to_string(path).map_err(DatabaseError::io("read", path))?;
        let malformed = |reason: String| DatabaseError::Malformed {
            path: path.to_path_buf(),
            reason,
        };
        let document = Document::parse(&text).map_err(|error| malformed(error.to_string()))?;
        let encoding = Encoding::new(document.root_element());
        let find = |group: &str, name: Option<&str>| {
            let parent = document.descendants().find(|node| node.has_tag_name(group))?;
            let mut arrays = parent.children().filter(|node| node.has_tag_name("DataArray"));
            arrays.find(|node| name.is_none_or(|name| node.attribute("Name") == Some(name)))
        };
        let numbers = |group: &str, name: Option<&str>| {
            let what = name.unwrap_or("positions");
            let array = find(group, name).ok_or_else(|| malformed(format!("array `{what}` in {group} is missing")))?;
            let values = encoding
                .numbers(array)
                .map_err(|reason| malformed(format!("array `{what}`: {reason}")))?;
            finite(&format!("`{what}` in {}", path.display()), &values)?;
            Ok::<_, DatabaseError>(values)
        };
        let vectors = |values: Vec<f64>, what: &str| {
            let (vectors, rest) = values.as_chunks::<3>();
            if rest.is_empty() && !vectors.is_empty() {
                Ok(vectors.to_vec())
            } else {
                let found = values.len();
                Err(malformed(format!(
                    "array `{what}` has {found} numbers, expected three a node"
                )))
            }
        };
        let positions = vectors(numbers("Points", None)?, "positions")?;
        let velocities = match find("PointData", Some("velocity")) {
            None => None,
            Some(_) => Some(vectors(numbers("PointData", Some("velocity"))?, "velocity")?),
        };
        if let Some(found) = velocities.as_ref().map(Vec::len).filter(|n| *n != positions.len()) {
            let expected = positions.len();
            return Err(malformed(format!(
                "array `velocity` has {found} vectors, expected {expected}"
            )));
        }
        let types = numbers("Cells", Some("types"))?;
        let kind = |kind: u8| types.iter().all(|found| *found == f64::from(kind));
        let per_element = match (kind(TRIANGLE), kind(QUADRATIC_TRIANGLE)) {
            (true, false) => 3,
            (false, true) => 6,
            _ => {
                return Err(malformed(
                    "array `types`: expected triangles (5) or quadratic ones (22) alone".to_owned(),
                ));
            }
        };
        let connectivity = numbers("Cells", Some("connectivity"))?;
        if connectivity.len() != per_element * types.len() {
            let (found, expected) = (connectivity.len(), per_element * types.len());
            return Err(malformed(format!(
                "array `connectivity` has {found} numbers, expected {expected}"
            )));
        }
        let elements = elements(&connectivity, per_element, positions.len())?;
        Ok(Self {
            positions,
            velocities,
            elements,
        })
    }
}

/// How a file writes binary arrays.
struct Encoding {
    /// Bytes of the numbers in the headers of arrays.
    header: usize,
    compressed: bool,
    little_endian: bool,
}

impl Encoding {
    fn new(file: Node) -> Self {
        Self {
            header: if file.attribute("header_type") == Some("UInt64") {
                8
            } else {
                4
            },
            compressed: file.attribute("compressor") == Some("vtkZLibDataCompressor"),
            little_endian: file.attribute("byte_order") != Some("BigEndian"),
        }
    }

    /// The numbers of an array, or what is wrong with it.
    fn numbers(&self, array: Node) -> Result<Vec<f64>, String> {
        let text = array.text().unwrap_or_default();
        match array.attribute("format") {
            Some("ascii") => {
                let number = |word: &str| word.parse().map_err(|_| format!("`{word}` is not a number"));
                text.split_ascii_whitespace().map(number).collect()
            }
            Some("binary") if self.little_endian => {
                let bytes = self.bytes(text.trim()).ok_or("base64 data are damaged")?;
                from_bytes(&bytes, array.attribute("type").unwrap_or_default())
            }
            found => Err(format!(
                "format {}; expected ascii or little-endian binary, inline",
                found.unwrap_or("none")
            )),
        }
    }

    /// The bytes of base64 text: a header with the byte count, or with the counts and sizes of compressed blocks.
    fn bytes(&self, text: &str) -> Option<Vec<u8>> {
        let decode = |text: &str| BASE64_STANDARD.decode(text).ok();
        if !self.compressed {
            let all = decode(text)?;
            return Some(all.get(self.header..)?.to_vec());
        }
        // The header, (number of blocks, block size, last block's size, compressed sizes ...), is encoded by itself.
        let words = |text: &str| -> Option<Vec<u64>> {
            let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte));
            Some(decode(text)?.chunks_exact(self.header).map(word).collect())
        };
        let encoded = |words: usize| (words * self.header).div_ceil(3) * 4;
        let first = BASE64_STANDARD.decode(text.get(..self.header.div_ceil(3) * 4)?).ok()?;
        let count = first
            .get(..self.header)?
            .iter()
            .rev()
            .fold(0, |word, byte| word << 8 | usize::from(*byte));
        let length = encoded(count.checked_add(3)?);
        let sizes = words(text.get(..length)?)?;
        let mut rest = &decode(text.get(length..)?)?[..];
        let mut bytes = Vec::new();
        for size in sizes.iter().skip(3).take(count) {
            let (block, after) = rest.split_at_checked(usize::try_from(*size).ok()?)?;
            ZlibDecoder::new(block).read_to_end(&mut bytes).ok()?;
            rest = after;
        }
        Some(bytes)
    }
}

/// Numbers of a VTK type.
fn from_bytes(bytes: &[u8], kind: &str) -> Result<Vec<f64>, String> {
    macro_rules! read {
        ($kind:ty) => {{
            let (chunks, rest) = bytes.as_chunks::<{ size_of::<$kind>() }>();
            if !rest.is_empty() {
                return Err(format!("{} bytes are not whole numbers of type {kind}", bytes.len()));
            }
            Ok(chunks
                .iter()
                .map(|chunk| <$kind>::from_le_bytes(*chunk) as f64)
                .collect())
        }};
    }
    match kind {
        "Float64" => read!(f64),
        "Float32" => read!(f32),
        "Int64" => read!(i64),
        "Int32" => read!(i32),
        "UInt32" => read!(u32),
        "UInt64" => read!(u64),
        "UInt16" => read!(u16),
        "Int16" => read!(i16),
        "UInt8" => read!(u8),
        "Int8" => read!(i8),
        _ => Err(format!("type `{kind}`, expected one of VTK's numeric types")),
    }
}
