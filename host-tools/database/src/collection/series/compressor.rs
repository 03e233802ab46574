//! Blocks of compressed bytes.

use std::io::Read;

use flate2::read::ZlibDecoder;
use lzma_rust2::XzReader;

/// The most memory for a block of LZMA, in KiB: twice the dictionary of its highest level.
const LZMA_MEMORY: u32 = 128 << 10;

/// No block of LZ4 grows by more than this.
const LZ4_GROWTH: usize = 255;

/// The compressors of VTK's writers.
#[derive(Clone, Copy)]
pub(super) enum Compressor {
    Zlib,
    Lz4,
    Lzma,
}

impl Compressor {
    /// By VTK's name.
    pub fn named(name: &str) -> Result<Self, String> {
        match name {
            "vtkZLibDataCompressor" => Ok(Compressor::Zlib),
            "vtkLZ4DataCompressor" => Ok(Compressor::Lz4),
            "vtkLZMADataCompressor" => Ok(Compressor::Lzma),
            _ => Err(format!(
                "compressor `{name}`, expected vtkZLibDataCompressor, vtkLZ4DataCompressor, vtkLZMADataCompressor or \
                 none"
            )),
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Compressor::Zlib => "zlib",
            Compressor::Lz4 => "LZ4",
            Compressor::Lzma => "LZMA",
        }
    }

    /// The bytes of a block, about `size`, if it is sound.
    pub fn unpack(self, block: &[u8], size: usize) -> Option<Vec<u8>> {
        let mut bytes = Vec::new();
        let most = size as u64 + 1;
        match self {
            Compressor::Zlib => ZlibDecoder::new(block).take(most).read_to_end(&mut bytes).ok()?,
            Compressor::Lzma => {
                let reader = XzReader::new_mem_limit(block, false, LZMA_MEMORY);
                reader.take(most).read_to_end(&mut bytes).ok()?
            }
            Compressor::Lz4 if size / LZ4_GROWTH > block.len() => return None,
            Compressor::Lz4 => return lz4_flex::block::decompress(block, size).ok(),
        };
        Some(bytes)
    }
}
