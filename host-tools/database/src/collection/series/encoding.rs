//! Arrays of VTK files: as text, as base64 or as bytes, plain or compressed.

use roxmltree::Node;

use super::compressor::Compressor;
use super::numbers::{finite, from_bytes, from_text, size};
use super::stream::Stream;

/// How a file writes its arrays.
pub(super) struct Encoding<'a> {
    /// Bytes of the numbers in the headers of arrays.
    header: usize,
    compressor: Option<Compressor>,
    big_endian: bool,
    appended: Option<Stream<'a>>,
}

impl<'a> Encoding<'a> {
    /// Of a file's markup and what it has appended.
    ///
    /// # Errors
    /// The unsupported feature, by its name.
    pub fn new(file: Node, appended: Option<&'a [u8]>) -> Result<Self, String> {
        let other = |name: &str, found: &str, expected: &str| Err(format!("{name} `{found}`, expected {expected}"));
        let header = match file.attribute("header_type").unwrap_or("UInt32") {
            "UInt32" => 4,
            "UInt64" => 8,
            found => return other("header_type", found, "UInt32 or UInt64"),
        };
        let big_endian = match file.attribute("byte_order").unwrap_or("LittleEndian") {
            "LittleEndian" => false,
            "BigEndian" => true,
            found => return other("byte_order", found, "LittleEndian or BigEndian"),
        };
        let compressor = match file.attribute("compressor").unwrap_or_default() {
            "" => None,
            name => Some(Compressor::named(name)?),
        };
        let node = file.children().find(|node| node.has_tag_name("AppendedData"));
        let appended = match (
            node.map(|node| node.attribute("encoding").unwrap_or("base64")),
            appended,
        ) {
            (Some("base64"), Some(data)) => Some(Stream::base64(data)),
            (Some("raw"), Some(data)) => Some(Stream::Raw(data)),
            (Some(found), _) => return other("encoding of AppendedData", found, "base64 or raw"),
            (None, _) => None,
        };
        Ok(Self {
            header,
            compressor,
            big_endian,
            appended,
        })
    }

    /// The numbers of an array, `count` of them.
    ///
    /// # Errors
    /// The fault: found and expected.
    pub fn numbers(&self, array: Node, count: usize) -> Result<Vec<f64>, String> {
        let kind = array.attribute("type").unwrap_or_default();
        let size = size(kind)?;
        // Notes of the writer stand between the elements' text.
        let text: String = array
            .children()
            .filter_map(|child| child.text().filter(|_| child.is_text()))
            .collect();
        let mut stream = match array.attribute("format").unwrap_or("ascii") {
            "ascii" => return finite(from_text(&text, count)?),
            "binary" => Stream::base64(text.as_bytes()),
            "appended" => self.appended_at(array.attribute("offset"))?,
            found => return Err(format!("format `{found}`, expected ascii, binary or appended")),
        };
        if count == 0 {
            return Ok(Vec::new());
        }
        let length = count
            .checked_mul(size)
            .ok_or_else(|| format!("{count} numbers are too many"))?;
        let content = self.content(&mut stream, length)?;
        if array.attribute("format") == Some("binary") {
            stream.end()?;
        }
        finite(from_bytes(&content, kind, self.big_endian))
    }

    fn appended_at(&self, offset: Option<&str>) -> Result<Stream<'a>, String> {
        let stream = self
            .appended
            .as_ref()
            .ok_or("appended, but the file has no AppendedData")?;
        let offset = offset.ok_or("appended, but has no `offset`")?;
        let place = offset
            .trim()
            .parse()
            .map_err(|_| format!("`offset` is `{offset}`, expected a whole number"))?;
        stream.at(place)
    }

    /// The bytes of an array, `length` of them: behind a header with the byte count, or with the number of compressed
    /// blocks, the size of each, that of the last (0: as the others), and their compressed sizes.
    fn content(&self, stream: &mut Stream, length: usize) -> Result<Vec<u8>, String> {
        let expect = |found: u64| match found == length as u64 {
            true => Ok(()),
            false => Err(format!("{found} bytes, expected {length}")),
        };
        let Some(compressor) = self.compressor else {
            expect(self.words(stream, 1)?[0])?;
            return stream.take(length);
        };
        let blocks = self.words(stream, 1)?[0];
        if blocks == 0 || blocks > length as u64 {
            return Err(format!("{blocks} compressed blocks, expected {length} bytes"));
        }
        let sizes = self.words(stream, 2 + blocks as usize)?;
        let last = if sizes[1] == 0 { sizes[0] } else { sizes[1] };
        let whole = (blocks - 1)
            .checked_mul(sizes[0])
            .and_then(|bytes| bytes.checked_add(last));
        expect(whole.unwrap_or(u64::MAX))?;
        let mut content = Vec::new();
        for (index, compressed) in sizes[2..].iter().enumerate() {
            let size = if index + 1 == blocks as usize { last } else { sizes[0] } as usize;
            let block = stream.take(usize::try_from(*compressed).unwrap_or(usize::MAX))?;
            let bytes = compressor.unpack(&block, size);
            let bytes = bytes.filter(|bytes| bytes.len() == size);
            let damaged = || {
                format!(
                    "compressed block {index} is damaged, expected {size} bytes of {}",
                    compressor.name()
                )
            };
            content.extend(bytes.ok_or_else(damaged)?);
        }
        Ok(content)
    }

    /// Numbers of a header.
    fn words(&self, stream: &mut Stream, count: usize) -> Result<Vec<u64>, String> {
        let bytes = stream.take(count.saturating_mul(self.header))?;
        let append = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        let word = |bytes: &[u8]| match self.big_endian {
            true => bytes.iter().fold(0, append),
            false => bytes.iter().rev().fold(0, append),
        };
        Ok(bytes.chunks_exact(self.header).map(word).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::prelude::{BASE64_STANDARD, Engine};
    use roxmltree::Document;

    /// The numbers of the array in a file with these attributes and appended data.
    fn read(file: &str, array: &str, appended: Option<(&str, &[u8])>, count: usize) -> Result<Vec<f64>, String> {
        let element = appended.map(|(encoding, _)| format!("<AppendedData encoding='{encoding}'/>"));
        let text = format!("<VTKFile {file}>{array}{}</VTKFile>", element.unwrap_or_default());
        let document = Document::parse(&text).unwrap();
        let root = document.root_element();
        let encoding = Encoding::new(root, appended.map(|(_, data)| data))?;
        encoding.numbers(root.first_element_child().unwrap(), count)
    }

    fn inline(kind: &str, text: &str) -> String {
        format!("<DataArray type='{kind}' format='binary'>{text}</DataArray>")
    }

    fn halves(count: usize) -> Vec<f64> {
        (0..count).map(|k| k as f64 / 2.0).collect()
    }

    /// 48 numbers in blocks of 160, 160 and 64 bytes, as VTK 9.7 writes them.
    const BLOCKS: [(&str, &str); 3] = [
        (
            "vtkZLibDataCompressor",
            "AwAAAKAAAABAAAAAPwAAADgAAAAiAAAAeNpjYEAGD+wh9Aco/QNKMzhAKBYozQGleaC0AJQWgtIiUFoMSktAaSkoLQOl5aC0ApRWhNJK\
             UFrZAQATzgjceNotx8kNgEAAxLAphvuGbWBLo3QEOB8ryVtTP9KyY8+BIyfOXLhy487j92ZOz1yeKb7UB7cKCn942mNgAAETBzDVAKUZ\
             TKF8KM1gBuVDaQZzKN/cAQChyAWt",
        ),
        (
            "vtkLZ4DataCompressor",
            "AwAAAKAAAABAAAAAVQAAAFoAAAApAAAAGQABACLgPw8AE/AIABP4CAAiAEAYABMECAATCAgAEwwIABMQCAATEggAExQIABMWCAATGAgA\
             ExoIABMcCAATHggAEyAIABMhCACgIkAAAAAAAAAjQBEAAQAhJEAHACMAJQgAEyYIABMnCAATKAgAEykIABMqCAATKwgAEywIABMtCAAT\
             LggAEy8IABIwCAATgAgAIwAxEAADCAAjADIQAAMIALAAM0AAAAAAAIAzQBEAAQAhNEAHABOACAAjADUQAAMIACMANhAAAwgAsAA3QAAA\
             AAAAgDdA",
        ),
        (
            "vtkLZMADataCompressor",
            "AwAAAKAAAABAAAAAbAAAAGwAAABUAAAA/Td6WFoAAAFpIt42A8A0oAEhARYAAAAAcBvCqeAAnwAsXQAAbNpQiPXYHmQm5qBLbxD5GAoV\
             Ck48ZWVOB3hyXvnBf0iZ5T2Gcker+b0AAACQvtXGAAFIoAEAAAAvpMXoPjANiwIAAAAAAVla/Td6WFoAAAFpIt42A8A0oAEhARYAAAAA\
             cBvCqeAAnwAsXQAAaYdh7erL8awoKBFddmBiitFhbEAioTyYH6bhPduqzWAPuzqghs40+goy6wA9HilkAAFIoAEAAAAvpMXoPjANiwIA\
             AAAAAVla/Td6WFoAAAFpIt42AsAhQCEBFgD+3s164AA/ABldAABpi2HdafwVJUj1f1gHkFnOIbusls9eyAAAAAAAndpgsQABMUAJ8weQ\
             kEKZDQEAAAAAAVla",
        ),
    ];

    #[test]
    fn compressed_blocks_of_vtk_are_read() {
        for (compressor, text) in BLOCKS {
            let file = format!("header_type='UInt32' compressor='{compressor}'");
            assert_eq!(
                read(&file, &inline("Float64", text), None, 48),
                Ok(halves(48)),
                "{compressor}"
            );
            let array = "<DataArray type='Float64' format='appended' offset='3'/>";
            let appended = format!("abc{text}AAAA");
            let found = read(&file, array, Some(("base64", appended.as_bytes())), 48);
            assert_eq!(found, Ok(halves(48)), "{compressor}");
            let bytes = [
                &BASE64_STANDARD.decode(&text[..32]).unwrap(),
                &BASE64_STANDARD.decode(&text[32..]).unwrap()[..],
            ];
            let found = read(&file, &array.replace('3', "0"), Some(("raw", &bytes.concat())), 48);
            assert_eq!(found, Ok(halves(48)), "{compressor}");
        }
    }

    #[test]
    fn damaged_blocks_are_named() {
        for ((compressor, text), name) in BLOCKS.into_iter().zip(["zlib", "LZ4", "LZMA"]) {
            let file = format!("compressor='{compressor}'");
            let refused = |text: &str, count: usize| read(&file, &inline("Float64", text), None, count).unwrap_err();
            assert_eq!(refused(text, 47), "384 bytes, expected 376");
            let error = refused(&text[..text.len() - 16], 48);
            assert!(error.contains("cut short"), "{error}");
            let zeros = format!("{}{}", &text[..32], "A".repeat(text.len() - 32));
            let error = refused(&zeros, 48);
            assert!(error.contains("block 0 is damaged") && error.contains(name), "{error}");
            assert!(refused("AAAAAAAAAAAAAAAA", 48).contains("0 compressed blocks"));
        }
    }

    /// Bytes of 1, 2 and 100 in a type of numbers, in either byte order.
    macro_rules! bytes {
        ($kind:ty) => {{
            let numbers = [1 as $kind, 2 as $kind, 100 as $kind];
            let [little, big] = [<$kind>::to_le_bytes, <$kind>::to_be_bytes].map(|bytes| numbers.map(bytes).concat());
            (little, big)
        }};
    }

    #[test]
    fn all_types_are_read_in_all_forms() {
        for (kind, (little, big)) in [
            ("Int8", bytes!(i8)),
            ("UInt8", bytes!(u8)),
            ("Int16", bytes!(i16)),
            ("UInt16", bytes!(u16)),
            ("Int32", bytes!(i32)),
            ("UInt32", bytes!(u32)),
            ("Int64", bytes!(i64)),
            ("UInt64", bytes!(u64)),
            ("Float32", bytes!(f32)),
            ("Float64", bytes!(f64)),
        ] {
            let length = little.len();
            let headers = [
                (
                    "UInt32",
                    (length as u32).to_le_bytes().to_vec(),
                    (length as u32).to_be_bytes().to_vec(),
                ),
                (
                    "UInt64",
                    (length as u64).to_le_bytes().to_vec(),
                    (length as u64).to_be_bytes().to_vec(),
                ),
            ];
            for (header_type, little_header, big_header) in headers {
                for (order, header, data) in [
                    ("LittleEndian", little_header, &little),
                    ("BigEndian", big_header, &big),
                ] {
                    let file = format!("header_type='{header_type}' byte_order='{order}'");
                    let encode = |bytes: &[u8]| BASE64_STANDARD.encode(bytes);
                    let whole = [&header[..], data].concat();
                    let wrapped: Vec<String> = encode(&whole).chars().map(|c| format!("{c}\n ")).collect();
                    let texts = [
                        encode(&whole),
                        encode(&header) + &encode(data),
                        wrapped.concat(),
                        encode(&whole).trim_end_matches('=').to_owned(),
                        encode(&[&whole[..], &[0; 5]].concat()),
                    ];
                    for text in texts {
                        let found = read(&file, &inline(kind, &text), None, 3);
                        assert_eq!(found, Ok(vec![1.0, 2.0, 100.0]), "{file} {kind} {text}");
                    }
                    let array = format!("<DataArray type='{kind}' format='appended' offset='7'/>");
                    let raw = [&[b'<'; 7][..], &whole, &whole].concat();
                    let found = read(&file, &array, Some(("raw", &raw)), 3);
                    assert_eq!(found, Ok(vec![1.0, 2.0, 100.0]), "{file} {kind}");
                }
            }
        }
    }

    #[test]
    fn text_may_hold_comments_and_notes() {
        let array = |text: &str| format!("<DataArray type='Float32'>{text}</DataArray>");
        for text in [
            "0.5<!-- 7 -->\n1e1 -2",
            "<![CDATA[0.5 10]]>\t-2 <InformationKey>3</InformationKey>",
            "5e-1 10. -2",
        ] {
            assert_eq!(read("", &array(text), None, 3), Ok(vec![0.5, 10.0, -2.0]), "{text}");
        }
        for (text, reason) in [
            ("1 2", "2 numbers, expected 3"),
            ("1 2 x", "`x`, expected a number"),
            ("1 nan 3", "value 1 is NaN, expected finite numbers only"),
            ("1 2 1e999", "value 2 is inf, expected finite numbers only"),
        ] {
            assert_eq!(read("", &array(text), None, 3), Err(reason.to_owned()));
        }
    }

    #[test]
    fn other_forms_are_named() {
        let good = "<DataArray type='Int8' format='ascii'>1</DataArray>";
        for (file, array, appended, words) in [
            (
                "compressor='vtkZfpDataCompressor'",
                good,
                None,
                &["`vtkZfpDataCompressor`", "vtkLZ4"][..],
            ),
            ("header_type='UInt16'", good, None, &["`UInt16`", "UInt64"]),
            ("byte_order='Middle'", good, None, &["`Middle`", "BigEndian"]),
            ("", good, Some(("hex", &b"00"[..])), &["`hex`", "raw"]),
            (
                "",
                "<DataArray type='String' format='ascii'>1</DataArray>",
                None,
                &["`String`", "Float64"],
            ),
            (
                "",
                "<DataArray type='Int8' format='hex'>1</DataArray>",
                None,
                &["`hex`", "appended"],
            ),
            (
                "",
                "<DataArray type='Int8' format='binary'>!!!!!!!!</DataArray>",
                None,
                &["base64"],
            ),
            (
                "",
                "<DataArray type='Int8' format='binary'>AgAAAAECAw==</DataArray>",
                None,
                &["2 bytes, expected 1"],
            ),
            (
                "",
                "<DataArray type='Int8' format='binary'>AQAAAAECAw==</DataArray>",
                None,
                &["2 bytes more"],
            ),
            (
                "",
                "<DataArray type='Int8' format='binary'></DataArray>",
                None,
                &["cut short: 0 bytes, expected 4"],
            ),
            (
                "",
                "<DataArray type='Int8' format='appended' offset='0'/>",
                None,
                &["no AppendedData"],
            ),
            (
                "",
                "<DataArray type='Int8' format='appended'/>",
                Some(("raw", b"00")),
                &["no `offset`"],
            ),
            (
                "",
                "<DataArray type='Int8' format='appended' offset='-1'/>",
                Some(("raw", b"00")),
                &["`-1`"],
            ),
            (
                "",
                "<DataArray type='Int8' format='appended' offset='9'/>",
                Some(("raw", b"00")),
                &["9", "beyond", "2 long"],
            ),
            (
                "",
                "<DataArray type='Int8' format='appended' offset='0'/>",
                Some(("raw", b"00")),
                &["cut short"],
            ),
        ] {
            let error = read(file, array, appended, 1).unwrap_err();
            assert!(words.iter().all(|word| error.contains(word)), "{file} {array}: {error}");
        }
    }
}
