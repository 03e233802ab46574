//! Collections in HDF5 files: the arrays are datasets of the root group, or links to datasets.

use std::path::{Path, PathBuf};

use ndarray::{ArrayD, IxDyn};
use rust_hdf5::{DatatypeMessage, H5Dataset, H5File, Hdf5Error};

use super::arrays::Arrays;
use crate::DatabaseError;

/// The filters that are read, by their registered numbers: gzip, shuffle, Fletcher's checksum, szip, n-bit,
/// scale-offset, LZF.
const FILTERS: [u16; 7] = [1, 2, 3, 4, 5, 6, 32000];

/// Filters that h5py users meet and that are not read.
const OTHER_FILTERS: [(u16, &str); 7] = [
    (307, "bzip2"),
    (32001, "Blosc"),
    (32004, "LZ4"),
    (32008, "Bitshuffle"),
    (32013, "ZFP"),
    (32015, "Zstandard"),
    (32026, "Blosc2"),
];

/// How h5py makes a file that is read whatever the old one was.
const REWRITE: &str = "h5py rewrites the file: `with h5py.File(\"in.h5\") as a, h5py.File(\"out.h5\", \"w\") as b: \
                       [b.create_dataset(name, data=a[name][()]) for name in a]`";

/// An HDF5 file.
pub(crate) struct Archive {
    path: PathBuf,
    file: H5File,
    names: Vec<String>,
}

impl Archive {
    pub(crate) fn open(path: &Path) -> Result<Self, DatabaseError> {
        // The library's own error for a file that cannot be read would not say which operation failed.
        std::fs::File::open(path).map_err(DatabaseError::io("read", path))?;
        let corrupt = |error: Hdf5Error| DatabaseError::Corrupt {
            path: path.to_path_buf(),
            reason: words(&error),
        };
        let file = H5File::open(path).map_err(corrupt)?;
        let names = file.root_group().link_names().map_err(corrupt)?;
        Ok(Self {
            path: path.to_path_buf(),
            file,
            names,
        })
    }

    fn malformed(&self, name: &str, reason: &str) -> DatabaseError {
        DatabaseError::Malformed {
            path: self.path.clone(),
            reason: format!("array `{name}` {reason}"),
        }
    }

    fn unread(&self, name: &str, error: &Hdf5Error) -> DatabaseError {
        let reason = match error {
            Hdf5Error::DanglingLink { target, .. } => format!("is a link to `{target}`, which does not exist"),
            Hdf5Error::NotFound(_) => "is no dataset; expected one in the root group".to_owned(),
            other => format!("cannot be read: {}; {REWRITE}", words(other)),
        };
        self.malformed(name, &reason)
    }

    fn wrong(&self, name: &str, expected: &str, found: &DatatypeMessage, remedy: &str) -> DatabaseError {
        let reason = format!("holds elements of type {found}, expected {expected}: `{remedy}` in NumPy converts them");
        self.malformed(name, &reason)
    }

    /// A dataset whose filters are read.
    fn dataset(&self, name: &str) -> Result<H5Dataset, DatabaseError> {
        let unread = |error| self.unread(name, &error);
        let dataset = self.file.dataset(name).map_err(unread)?;
        let filters = dataset.filters().map_err(unread)?;
        match filters.iter().find(|filter| !FILTERS.contains(&filter.id)) {
            None => Ok(dataset),
            Some(filter) => {
                let known = OTHER_FILTERS.iter().find(|(id, _)| *id == filter.id);
                let filter = known.map_or(format!("number {}", filter.id), |(_, name)| (*name).to_owned());
                let reason = format!(
                    "is compressed by the filter {filter}, expected none, gzip, szip or LZF; with hdf5plugin {REWRITE}"
                );
                Err(self.malformed(name, &reason))
            }
        }
    }
}

impl Arrays for Archive {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn numbers(&mut self, name: &str) -> Result<ArrayD<f64>, DatabaseError> {
        let unread = |error| self.unread(name, &error);
        let dataset = self.dataset(name)?;
        let kind = dataset.datatype().map_err(unread)?;
        let values = match kind {
            DatatypeMessage::FixedPoint { signed: true, .. } => {
                let integers = dataset.read_numeric_as::<i64>().map_err(unread)?;
                integers.into_iter().map(|x| x as f64).collect()
            }
            DatatypeMessage::FixedPoint { signed: false, .. } => {
                let integers = dataset.read_numeric_as::<u64>().map_err(unread)?;
                integers.into_iter().map(|x| x as f64).collect()
            }
            DatatypeMessage::FloatingPoint { size: 2 | 4 | 8, .. } => {
                dataset.read_numeric_as::<f64>().map_err(unread)?
            }
            other => {
                let flags = matches!(other, DatatypeMessage::Enum { .. });
                let remedy = if flags { ".astype(int)" } else { ".astype(float)" };
                return Err(self.wrong(name, "real numbers", &other, remedy));
            }
        };
        let (shape, count) = (dataset.shape(), values.len());
        let reason = format!("holds {count} numbers, which do not fill its shape");
        ArrayD::from_shape_vec(IxDyn(&shape), values).map_err(|_| self.malformed(name, &reason))
    }

    fn texts(&mut self, name: &str) -> Result<Vec<String>, DatabaseError> {
        let unread = |error| self.unread(name, &error);
        let dataset = self.dataset(name)?;
        let texts = match dataset.datatype().map_err(unread)? {
            DatatypeMessage::FixedString { .. } | DatatypeMessage::VarLenString { .. } => {
                dataset.read_strings().map_err(unread)?
            }
            other => return Err(self.wrong(name, "text", &other, ".astype(str)")),
        };
        let trimmed = texts.iter().map(|text| text.trim_end_matches('\0').to_owned());
        Ok(trimmed.collect())
    }
}

/// The library's message without the names of its layers.
fn words(error: &Hdf5Error) -> String {
    let text = error.to_string();
    let layers = [
        "hdf5-io error: ",
        "format error: ",
        "I/O error: ",
        "invalid state: ",
        "type mismatch: ",
        "unsupported: ",
    ];
    let mut words = text.as_str();
    while let Some(inner) = layers.iter().find_map(|layer| words.strip_prefix(layer)) {
        words = inner;
    }
    words.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rust_hdf5::{H5FileOptions, HBool, LibverBound};

    /// A file that `write` fills, opened.
    fn file(options: H5FileOptions, write: impl Fn(&H5File) -> rust_hdf5::Result<()>) -> (tempfile::TempDir, Archive) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("data.h5");
        let file = options.create(&path).unwrap();
        write(&file).unwrap();
        file.close().unwrap();
        let archive = Archive::open(&path).unwrap();
        (directory, archive)
    }

    fn sines(count: usize) -> Vec<f64> {
        (0..count).map(|k| (k as f64).sin()).collect()
    }

    #[test]
    fn chunks_are_read_with_every_number_of_unlimited_axes() {
        // No unlimited axis, one and several have indices of their own, as do files for old libraries.
        for bound in [LibverBound::Earliest, LibverBound::V110, LibverBound::V200] {
            for unlimited in 0..=3 {
                let extent = [7, 5, 3];
                let most: Vec<Option<usize>> = (0..3).map(|d| (d >= unlimited).then_some(extent[d])).collect();
                let (_directory, mut archive) = file(H5FileOptions::default().libver(bound), |file| {
                    let dataset = file
                        .new_dataset::<f64>()
                        .shape(extent)
                        .chunk(&[2, 2, 3])
                        .max_shape(&most);
                    dataset
                        .shuffle_deflate(6)
                        .create("positions")?
                        .write_slice(&[0; 3], &extent, &sines(105))
                });
                let array = archive.numbers("positions").unwrap();
                assert_eq!(array.shape(), extent);
                assert_eq!(array.into_raw_vec_and_offset().0, sines(105), "{bound:?} {unlimited}");
            }
        }
    }

    #[test]
    fn links_are_followed_and_others_do_not_disturb() {
        for bound in [LibverBound::Earliest, LibverBound::V200] {
            let (_directory, mut archive) = file(H5FileOptions::default().libver(bound), |file| {
                let group = file.create_group("group")?;
                group
                    .new_dataset::<f64>()
                    .shape([4])
                    .create("there")?
                    .write_raw(&sines(4))?;
                let root = file.root_group();
                root.create_soft_link("times", "/group/there")?;
                root.create_soft_link("lost", "/nowhere")?;
                root.create_external_link("elsewhere", "other.h5", "/x")
            });
            assert_eq!(archive.numbers("times").unwrap().into_raw_vec_and_offset().0, sines(4));
            let lost = archive.numbers("lost").unwrap_err().to_string();
            assert!(
                lost.contains("array `lost` is a link to `/nowhere`, which does not exist"),
                "{lost}"
            );
            let elsewhere = archive.numbers("elsewhere").unwrap_err().to_string();
            assert!(
                elsewhere.contains("`elsewhere`") && elsewhere.contains("other.h5"),
                "{elsewhere}"
            );
            let group = archive.numbers("group").unwrap_err().to_string();
            assert!(group.contains("array `group` is no dataset"), "{group}");
        }
    }

    #[test]
    fn integers_and_texts_are_read_and_other_types_named() {
        let (_directory, mut archive) = file(H5FileOptions::default(), |file| {
            file.new_dataset::<i16>()
                .shape([2])
                .create("short")?
                .write_raw(&[-7i16, 300])?;
            file.new_dataset::<u64>()
                .shape([1])
                .create("long")?
                .write_raw(&[1u64 << 63])?;
            file.new_dataset::<HBool>()
                .shape([1])
                .create("flags")?
                .write_raw(&[HBool::from(true)])?;
            file.write_vlen_strings("names", &["größe", "流れ"]).map(|_| ())
        });
        assert_eq!(
            archive.numbers("short").unwrap().into_raw_vec_and_offset().0,
            [-7.0, 300.0]
        );
        assert_eq!(
            archive.numbers("long").unwrap().into_raw_vec_and_offset().0,
            [2f64.powi(63)]
        );
        assert_eq!(archive.texts("names").unwrap(), ["größe", "流れ"]);
        let flags = archive.numbers("flags").unwrap_err().to_string();
        assert!(
            flags.contains("array `flags` holds elements of type") && flags.contains(".astype(int)"),
            "{flags}"
        );
        let numbers = archive.texts("short").unwrap_err().to_string();
        assert!(
            numbers.contains("array `short`") && numbers.contains("expected text"),
            "{numbers}"
        );
    }
}
