//! XML files of VTK: their markup, and the appended data, which need not be XML.

use std::ops::Range;

use roxmltree::Document;

/// The text of a file without its appended data, and those data.
pub(super) struct Markup {
    text: String,
    appended: Option<Vec<u8>>,
}

impl Markup {
    /// Parts the bytes of a file.
    ///
    /// # Errors
    /// Files of another kind, by its name, and those that are cut short.
    pub fn new(bytes: &[u8]) -> Result<Self, String> {
        if let Some(kind) = other_kind(bytes) {
            return Err(kind.to_owned());
        }
        let Some(range) = appended(bytes)? else {
            let text = decode(bytes)?;
            return Ok(Self { text, appended: None });
        };
        let markup = [&bytes[..range.start], &bytes[range.end..]].concat();
        Ok(Self {
            text: decode(&markup)?,
            appended: Some(bytes[range].to_vec()),
        })
    }

    /// The bytes after the underscore in `AppendedData`.
    pub fn appended(&self) -> Option<&[u8]> {
        self.appended.as_deref()
    }

    /// The markup, if it is of that type of VTK file.
    ///
    /// # Errors
    /// Malformed XML and other types, by their name.
    pub fn document(&self, expected: &str) -> Result<Document<'_>, String> {
        let document = Document::parse(&self.text).map_err(|error| format!("damaged or cut short: {error}"))?;
        let root = document.root_element();
        let found = root.attribute("type").unwrap_or_default();
        if !root.has_tag_name("VTKFile") {
            let name = root.tag_name().name();
            return Err(format!(
                "XML of the kind `{name}`, expected a VTKFile of type {expected}"
            ));
        }
        if found != expected {
            let advice = advice(found);
            return Err(format!("VTKFile of type `{found}`, expected {expected}{advice}"));
        }
        Ok(document)
    }
}

/// Names the kind of a file that is no XML.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    let kinds: [(&[u8], _); 5] = [
        (b"\x1f\x8b", "compressed by gzip; unpack it first"),
        (
            b"# vtk DataFile",
            "a legacy VTK file; save it as XML unstructured grid (.vtu)",
        ),
        (b"\x89HDF", "a VTKHDF file; save it as XML unstructured grid (.vtu)"),
        (b"\xff\xfe", "text in UTF-16; save it in UTF-8"),
        (b"\xfe\xff", "text in UTF-16; save it in UTF-8"),
    ];
    if bytes.is_empty() {
        return Some("the file is empty");
    }
    kinds
        .iter()
        .find(|(start, _)| bytes.starts_with(start))
        .map(|(_, kind)| *kind)
}

/// How to come from another type to one that is read.
fn advice(found: &str) -> &'static str {
    match found {
        "PolyData" => ": save the surface as unstructured grid (.vtu)",
        "PUnstructuredGrid" => {
            ": list the pieces (.vtu) of the parallel file (.pvtu) as parts of a timestep in the PVD file"
        }
        "PPolyData" => ": save the surface as one unstructured grid (.vtu)",
        "vtkMultiBlockDataSet" | "vtkPartitionedDataSet" | "vtkPartitionedDataSetCollection" => {
            ": save the capsule's block as unstructured grid (.vtu)"
        }
        "UnstructuredGrid" => ": name a PVD file, which lists the files of the series by time",
        _ => "",
    }
}

/// Where the appended data are: from behind the underscore to the last closing tag of `AppendedData`.
fn appended(bytes: &[u8]) -> Result<Option<Range<usize>>, String> {
    let find = |word: &[u8], from: usize| {
        let place = bytes[from..].windows(word.len()).position(|window| window == word);
        place.map(|place| from + place)
    };
    let Some(open) = find(b"<AppendedData", 0) else {
        return Ok(None);
    };
    let content = find(b">", open).ok_or("cut short in the tag AppendedData")? + 1;
    let blank = bytes[content..].iter().take_while(|byte| byte.is_ascii_whitespace());
    let start = content + blank.count() + 1;
    if bytes.get(start - 1) != Some(&b'_') {
        return Err("AppendedData do not begin with `_`".to_owned());
    }
    let closing = b"</AppendedData";
    let length = bytes[start..]
        .windows(closing.len())
        .rposition(|window| window == closing);
    let length = length.ok_or("cut short: AppendedData have no end")?;
    Ok(Some(start..start + length))
}

/// Text in UTF-8, or in ISO 8859-1 if the file says so.
fn decode(bytes: &[u8]) -> Result<String, String> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.to_owned()),
        Err(error) => {
            let declaration = bytes.split(|byte| *byte == b'>').next().unwrap_or_default();
            let declaration = String::from_utf8_lossy(declaration).to_lowercase();
            if declaration.starts_with("<?xml") && declaration.contains("iso-8859-1") {
                Ok(bytes.iter().map(|byte| char::from(*byte)).collect())
            } else {
                Err(format!("byte {} is not text in UTF-8", error.valid_up_to()))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn appended_bytes_need_not_be_xml() {
        let data = b"\x00<\xff&</AppendedData>\n_";
        let file = [
            &b"<VTKFile type='UnstructuredGrid'><AppendedData encoding='raw'>\n  _"[..],
            data,
            b"</AppendedData></VTKFile>",
        ]
        .concat();
        let markup = Markup::new(&file).unwrap();
        assert_eq!(markup.appended(), Some(&data[..]));
        let document = markup.document("UnstructuredGrid").unwrap();
        let node = document.descendants().find(|node| node.has_tag_name("AppendedData"));
        assert_eq!(node.unwrap().attribute("encoding"), Some("raw"));
    }

    #[test]
    fn marks_and_encodings_of_text_are_understood() {
        let plain = "<VTKFile type='UnstructuredGrid' by='J\u{fc}rgen' xmlns='http://vtk.org'/>";
        let name = |bytes: &[u8]| {
            let markup = Markup::new(bytes)?;
            let document = markup.document("UnstructuredGrid")?;
            Ok::<_, String>(document.root_element().attribute("by").map(str::to_owned))
        };
        let expected = Ok(Some("J\u{fc}rgen".to_owned()));
        assert_eq!(name(plain.as_bytes()), expected);
        assert_eq!(name(format!("\u{feff}{plain}").as_bytes()), expected);
        let latin: Vec<u8> = plain.chars().map(|c| c as u8).collect();
        let declared = [b"<?xml version='1.0' encoding='ISO-8859-1'?>", &latin[..]].concat();
        assert_eq!(name(&declared), expected);
        let error = name(&latin).unwrap_err();
        assert!(error.contains("byte 38") && error.contains("UTF-8"), "{error}");
    }

    #[test]
    fn files_of_another_kind_are_named() {
        let typed = |kind: &str| format!("<VTKFile type='{kind}'/>").into_bytes();
        for (bytes, words) in [
            (Vec::new(), &["empty"][..]),
            (b"\x1f\x8b\x08".to_vec(), &["gzip", "unpack"]),
            (b"# vtk DataFile Version 3.0".to_vec(), &["legacy", ".vtu"]),
            (b"\x89HDF\r\n".to_vec(), &["VTKHDF"]),
            (b"\xff\xfe<\0".to_vec(), &["UTF-16", "UTF-8"]),
            (b"<Xdmf/>".to_vec(), &["Xdmf", "VTKFile of type UnstructuredGrid"]),
            (b"<VTKFile type='UnstructuredGrid'><Piece>".to_vec(), &["cut short"]),
            (
                b"<VTKFile type='UnstructuredGrid'><AppendedData>_AAAA".to_vec(),
                &["cut short", "AppendedData"],
            ),
            (
                b"<VTKFile><AppendedData>AAAA</AppendedData>".to_vec(),
                &["AppendedData", "`_`"],
            ),
            (typed("PolyData"), &["`PolyData`", "save"]),
            (typed("PUnstructuredGrid"), &["`PUnstructuredGrid`", "parts"]),
            (typed("vtkMultiBlockDataSet"), &["`vtkMultiBlockDataSet`", "block"]),
            (typed("ImageData"), &["`ImageData`", "expected UnstructuredGrid"]),
        ] {
            let markup = Markup::new(&bytes);
            let error = markup.and_then(|markup| markup.document("UnstructuredGrid").map(|_| ()));
            let error = error.unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
