//! The header of the C interface, generated from its Rust sources.

use crate::root;
use anyhow::{Context, Result};
use std::fmt::Write as _;
use std::path::PathBuf;

/// The prefix of every symbol, and that of the names that programs use instead.
pub const VERSIONED: &str = "capsule_v1_";
const PLAIN: &str = "capsule_";

const INTRODUCTION: &str = "\
/* capsule-rom: from capillary number and confinement to the motion of a microcapsule in a square channel.

   No heap, no global state. Lengths are in l (half the channel's side), velocities in V (mean velocity of the
   undisturbed flow), time in l/V. Single precision.

     capsule_open        a model file in memory -> capsule_model
     capsule_initialise  memory -> capsule_workspace
     capsule_prepare     parameters -> the workspace is ready for any instant
     capsule_..._at      what is asked at an instant; it computes that and nothing else

   Every function returns a status; capsule_status_text() says it in words. The last parameter, `error`, may be null;
   else every call fills it, with the figures of the failure or with zeros. Pointers may not be null unless it is said;
   null, misaligned, short and overlapping ones are refused. Where `error` itself is misaligned, or shares memory with
   another argument or with the model's file, the call is refused and `error` is left as it was.

   Where a call fails, nothing else is written, but for the `domain` of capsule_prepare, the `scratch` of
   capsule_membrane_at and a model that did not open. A buffer is written as far as the answer goes, and not beyond.

   libcapsule_direct.a is without the paper's method, in half the workspace and four fifths of the code. A program that
   links it defines CAPSULE_DIRECT before it includes this.

   A model file's bytes stay where they are, unchanged, as long as its model is used. Calls that share a model only may
   run at the same time; calls that share a workspace may not. */
";

/// Where the committed header is.
pub fn path() -> PathBuf {
    root().join("core/capi/include/capsule.h")
}

/// Writes the header.
pub fn write() -> Result<()> {
    std::fs::write(path(), generate()?).with_context(|| format!("could not write {}", path().display()))
}

/// The header's text.
fn generate() -> Result<String> {
    let folder = root().join("core/capi");
    let mut config = cbindgen::Config::from_file(folder.join("cbindgen.toml").to_string_lossy().as_ref())
        .map_err(|error| anyhow::anyhow!("cbindgen.toml: {error}"))?;
    config.header = Some(INTRODUCTION.trim_end().to_owned());
    let bindings = cbindgen::Builder::new()
        .with_crate(&folder)
        .with_config(config)
        .generate()
        .context("cbindgen on core/capi")?;
    let mut bytes = Vec::new();
    bindings.write(&mut bytes);
    let text = String::from_utf8(bytes).context("cbindgen writes UTF-8")?;
    // The safety sections of the Rust functions have one place in C: the introduction.
    let text = text.replace("//\n// # Safety\n// See [`functions`](crate::functions).\n", "");
    let Some((declarations, end)) = text.rsplit_once("#endif  /* CAPSULE_H */") else {
        anyhow::bail!("cbindgen wrote no include guard");
    };
    let mut header = with_version(declarations)?;
    header.push_str("/* Plain names of the functions of this version. */\n");
    for name in functions(declarations) {
        writeln!(header, "#define {PLAIN}{name} {VERSIONED}{name}")?;
    }
    write!(header, "\n#endif  /* CAPSULE_H */{end}")?;
    Ok(header)
}

/// The declarations after the version of the library, for the preprocessor.
fn with_version(declarations: &str) -> Result<String> {
    let (start, rest) = declarations
        .split_once("#include <stdint.h>\n")
        .context("cbindgen wrote no includes")?;
    let version = env!("CARGO_PKG_VERSION");
    let mut header = format!("{start}#include <stdint.h>\n\n// Version of the library.\n");
    writeln!(header, "#define CAPSULE_VERSION \"{version}\"")?;
    for (name, number) in ["MAJOR", "MINOR", "PATCH"].iter().zip(version.split('.')) {
        writeln!(header, "#define CAPSULE_VERSION_{name} {number}")?;
    }
    header.push_str(rest);
    Ok(header)
}

/// Names of the functions that are declared, without their prefix.
pub fn functions(declarations: &str) -> impl Iterator<Item = &str> {
    declarations
        .split(VERSIONED)
        .skip(1)
        .filter_map(|rest| rest.split_once('('))
        .map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_header_is_current() {
        let committed = std::fs::read_to_string(path()).unwrap();
        assert!(committed == generate().unwrap(), "run `cargo xtask header`");
    }
}
