//! The page of `study report`, which runs the stability study too, on a part of the data.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[test]
fn the_page_stands_alone_and_nothing_is_answered_wrongly() {
    let folder = tempfile::tempdir().unwrap();
    let status = Command::new(env!("CARGO_BIN_EXE_capsule-rom"))
        .current_dir(root())
        .args(["study", "report", "--quick", "--quiet", "--out"])
        .arg(folder.path())
        .status()
        .unwrap();
    assert!(status.success());
    let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
    for figure in 7..=14 {
        assert!(page.contains(&format!("Fig. {figure}")), "Fig. {figure} is missing");
    }
    // Nothing is fetched: no script, no style sheet, no image.
    for tag in ["<script", "<link", "<img", "src=", "url(", "@import"] {
        assert!(!page.contains(tag), "{tag}");
    }
    let drawings = page.matches("<svg ").count();
    assert!(drawings > 40 && drawings == page.matches("<svg role=\"img\" aria-label=\"").count());
    // Every file that is named is there.
    for link in page
        .split("<a href=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
    {
        assert!(link.starts_with('#') || folder.path().join(link).exists(), "{link}");
    }
    let mut checks = csv::Reader::from_path(folder.path().join("stability_checks.csv")).unwrap();
    for check in checks.records() {
        let check = check.unwrap();
        assert_eq!(&check[4], "0", "{check:?}");
    }
    // Neither method fails at a configuration that it does not know.
    let mut settings = csv::Reader::from_path(folder.path().join("stability_settings.csv")).unwrap();
    for row in settings.records() {
        let row = row.unwrap();
        assert!(&row[0] != "step / (l/V)" || &row[7] == "0", "{row:?}");
    }
}
