//! Tables as CSV: names and texts are quoted where they need it.

use crate::DatabaseError;

/// A heading and rows as CSV; `title`, if there is one, becomes a comment in the first line.
///
/// # Errors
/// [`DatabaseError::WrongLength`] for a row that is not as long as the heading.
pub fn csv<H, R>(
    title: Option<&str>,
    heading: impl IntoIterator<Item = H>,
    rows: impl IntoIterator<Item = R>,
) -> Result<Vec<u8>, DatabaseError>
where
    H: AsRef<[u8]>,
    R: IntoIterator<Item: AsRef<[u8]>>,
{
    let mut text = Vec::new();
    if let Some(title) = title {
        // A name in it may hold line breaks, which would end the comment.
        let line: String = title.replace(['\r', '\n'], " ");
        text.extend_from_slice(format!("# {line}\n").as_bytes());
    }
    let mut writer = csv::Writer::from_writer(&mut text);
    writer.write_record(heading).map_err(unequal)?;
    for row in rows {
        writer.write_record(row).map_err(unequal)?;
    }
    // Dropping flushes into memory, which cannot fail.
    drop(writer);
    Ok(text)
}

/// A writer into memory only fails for rows of unequal length.
fn unequal(error: csv::Error) -> DatabaseError {
    let (expected, found) = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => (*expected_len as usize, *len as usize),
        _ => (0, 0),
    };
    DatabaseError::WrongLength {
        what: "cells of a row".to_owned(),
        expected,
        found,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let heading = ["plain", "Q, flow", "the \"size\"", "Größe"];
        let rows = [["1", "2", "3", "4"], ["a\nb", "", " ", "#"]];
        let text = csv(Some("Q\nflow = 1"), heading, rows).unwrap();
        assert!(text.starts_with(b"# Q flow = 1\nplain,\"Q, flow\","));
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(&text[..]);
        assert_eq!(reader.headers().unwrap(), &heading[..]);
        let read: Vec<_> = reader.records().map(Result::unwrap).collect();
        assert!(read.iter().zip(rows).all(|(found, row)| *found == row[..]) && read.len() == 2);
    }

    #[test]
    fn rows_of_another_length_are_refused() {
        let error = csv(None, ["a", "b"], [["1"]]).unwrap_err();
        assert!(
            matches!(
                error,
                DatabaseError::WrongLength {
                    expected: 2,
                    found: 1,
                    ..
                }
            ),
            "{error}"
        );
    }
}
