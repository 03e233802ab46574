//! Collections in NPZ archives.

use ndarray::ArrayD;
use ndarray_npy::{ReadNpyError, ReadNpzError, ReadableElement};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use zip::ZipArchive;

use super::arrays::Arrays;
use crate::DatabaseError;
use crate::npz::Reader;

/// An archive that NumPy's `savez` or `savez_compressed` wrote.
pub(crate) struct Archive {
    reader: Reader,
    names: Vec<String>,
}

impl Archive {
    pub(crate) fn open(path: &Path) -> Result<Self, DatabaseError> {
        let mut reader = Reader::open(path)?;
        let names = reader.names()?;
        Ok(Self { reader, names })
    }

    fn corrupt(&self, name: &str, reason: impl std::fmt::Display) -> DatabaseError {
        DatabaseError::Corrupt {
            path: self.path().to_path_buf(),
            reason: format!("array `{name}`: {reason}"),
        }
    }

    /// The array if its elements are of this type, else their descriptor.
    fn of_type<T: ReadableElement>(
        &mut self,
        name: &str,
        value: impl Fn(&T) -> f64,
    ) -> Result<Result<ArrayD<f64>, String>, DatabaseError> {
        match self.reader.by_name::<T>(name) {
            Ok(array) => Ok(Ok(array.map(value))),
            Err(ReadNpzError::Npy(ReadNpyError::WrongDescriptor(found))) => Ok(Err(found.to_string())),
            Err(other) => Err(self.corrupt(name, other)),
        }
    }
}

impl Arrays for Archive {
    fn path(&self) -> &Path {
        self.reader.path()
    }

    fn has(&self, name: &str) -> bool {
        self.names.iter().any(|known| known == name)
    }

    fn numbers(&mut self, name: &str) -> Result<ArrayD<f64>, DatabaseError> {
        macro_rules! one_of {
            ($first:ty $(, $kind:ty)*) => {
                match self.of_type::<$first>(name, |x| *x as f64)? {
                    Ok(array) => return Ok(array),
                    Err(descriptor) => {
                        $(if let Ok(array) = self.of_type::<$kind>(name, |x| *x as f64)? {
                            return Ok(array);
                        })*
                        descriptor
                    }
                }
            };
        }
        let found = one_of!(f64, f32, i64, i32, u32, u64, u16, i16, u8, i8);
        Err(DatabaseError::WrongType {
            path: self.path().to_path_buf(),
            name: name.to_owned(),
            expected: "real numbers",
            found,
        })
    }

    /// Fixed-length text, which ndarray-npy does not read: `<U` (UTF-32) or `|S` (bytes), padded with zeros.
    fn texts(&mut self, name: &str) -> Result<Vec<String>, DatabaseError> {
        let path = self.path().to_path_buf();
        let file = File::open(&path).map_err(DatabaseError::io("read", &path))?;
        let mut bytes = Vec::new();
        ZipArchive::new(file)
            .and_then(|mut archive| Ok(archive.by_name(&format!("{name}.npy"))?.read_to_end(&mut bytes)?))
            .map_err(|error| self.corrupt(name, error))?;
        let (header, data) = split(&bytes).ok_or_else(|| self.corrupt(name, "not an NPY file"))?;
        let descriptor = header
            .split('\'')
            .skip_while(|part| *part != "descr")
            .nth(2)
            .unwrap_or_default();
        let width = descriptor.get(2..).and_then(|digits| digits.parse::<usize>().ok());
        let text: fn(&[u8]) -> Option<String> = match descriptor.get(..2) {
            Some("<U") => utf32,
            Some("|S") => |bytes| String::from_utf8(bytes.to_vec()).ok(),
            _ => return Err(self.not_text(name, descriptor)),
        };
        let unit = if descriptor.starts_with('<') { 4 } else { 1 };
        match width.map(|width| width * unit) {
            Some(width) if width > 0 => {
                let texts = data.chunks_exact(width).map(text);
                let trimmed = texts.map(|text| text.map(|text| text.trim_end_matches('\0').to_owned()));
                trimmed
                    .collect::<Option<_>>()
                    .ok_or_else(|| self.corrupt(name, "not text"))
            }
            _ => Err(self.not_text(name, descriptor)),
        }
    }
}

impl Archive {
    fn not_text(&self, name: &str, found: &str) -> DatabaseError {
        DatabaseError::WrongType {
            path: self.path().to_path_buf(),
            name: name.to_owned(),
            expected: "text of fixed length (NumPy's `U` or `S`)",
            found: found.to_owned(),
        }
    }
}

/// Header and data of an NPY file.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(b"\x93NUMPY")?;
    let (version, rest) = rest.split_first_chunk::<2>()?;
    let (length, rest) = if version[0] == 1 {
        let (length, rest) = rest.split_first_chunk::<2>()?;
        (usize::from(u16::from_le_bytes(*length)), rest)
    } else {
        let (length, rest) = rest.split_first_chunk::<4>()?;
        (u32::from_le_bytes(*length) as usize, rest)
    };
    let (header, data) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, data))
}

fn utf32(bytes: &[u8]) -> Option<String> {
    let (codes, _) = bytes.as_chunks::<4>();
    codes
        .iter()
        .map(|code| char::from_u32(u32::from_le_bytes(*code)))
        .collect()
}
