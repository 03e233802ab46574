//! Output that nobody reads: `capsule-rom ... | head`.
#![cfg(unix)]

use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};

/// The number of SIGPIPE, with which a command ends whose output was closed.
const SIGPIPE: i32 = 13;

#[test]
fn a_closed_output_ends_a_command_quietly() {
    let query = "--ca 0.1 --confinement 0.9 --t 1,2";
    for line in [
        "--help".to_owned(),
        "predict --help".to_owned(),
        "completions bash".to_owned(),
        format!("predict {query}"),
        format!("predict {query} --json"),
        "fom limit --database models/database".to_owned(),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
            .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
            .args(line.split_whitespace())
            .stdout(writer)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
            .wait_with_output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(
            (output.status.signal(), &*said),
            (Some(SIGPIPE), ""),
            "{line}: {}",
            output.status
        );
    }
}
