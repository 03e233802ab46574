//! Sweeps as a user runs them: interrupted, killed, parted, merged, on a full disk, with impossible designs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use capsule_database::{Database, Status};

/// Steady at the lower capillary numbers, not so soon at the higher ones.
const DESIGN: &str = "--ca 0.002,0.005,0.02,0.05,0.1 --confinement 0.75,0.8 --beyond 1 --bracket 0.008";
const SETTINGS: &str = "--mesh 2 --end-time 0.8 --tolerance 1e-3";

fn command(arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_capsule-rom"));
    command.args(arguments.split_whitespace()).stdin(Stdio::null());
    command
}

fn capsule_rom(arguments: &str) -> Output {
    command(arguments).output().expect("the command starts")
}

fn sweep(folder: &Path, more: &str) -> String {
    format!("fom sweep --database {} {SETTINGS} {more}", folder.display())
}

fn succeed(arguments: &str) -> String {
    let output = capsule_rom(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments}: {message}");
    assert!(message.is_empty(), "quiet when not at a terminal: {message}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Asserts the exit code and that the message on standard error holds all of `words`.
fn fails(arguments: &str, code: i32, words: &[&str]) {
    let output = capsule_rom(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments}: {message}");
    for word in words {
        assert!(message.contains(word), "{arguments}: \"{word}\" is not in: {message}");
    }
}

/// The files of a database with their bytes, without hidden ones.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry"));
    entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path()))
        .filter(|(name, _)| !name.starts_with('.'))
        .map(|(name, path)| (name, std::fs::read(path).expect("a file")))
        .collect()
}

/// The reference: an undisturbed sweep, and how long it takes.
fn undisturbed(folder: &Path) -> (BTreeMap<String, Vec<u8>>, Duration) {
    let start = Instant::now();
    succeed(&sweep(folder, DESIGN));
    (files(folder), start.elapsed())
}

/// Numbers from 0 to 1 that look random (splitmix64).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}

/// Sends `signal` to sweeps at random instants `count` times in all, starting each sweep again until it is done, and
/// compares what they leave.
fn disturb(signal: &str, count: usize) {
    let root = tempfile::tempdir().unwrap();
    let (expected, duration) = undisturbed(&root.path().join("undisturbed"));
    let longest = duration.mul_f64(0.4).min(Duration::from_secs(1));
    let (mut hits, mut state) = (0, 7);
    for round in 0.. {
        if hits >= count {
            break;
        }
        let folder = root.path().join(format!("disturbed-{round}"));
        loop {
            let mut process = command(&sweep(&folder, DESIGN))
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            if hits < count {
                std::thread::sleep(longest.mul_f64(random(&mut state)));
                if process.try_wait().unwrap().is_none() {
                    let id = process.id().to_string();
                    assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
                }
            }
            let output = process.wait_with_output().unwrap();
            if output.status.success() {
                break;
            }
            hits += 1;
            let message = String::from_utf8_lossy(&output.stderr);
            assert!(
                signal == "-KILL" || message.is_empty() || message.contains("goes on from there"),
                "{message}"
            );
        }
        let found = files(&folder);
        assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
        assert!(found == expected, "the files differ");
        assert!(!folder.join(".interrupted").exists(), "no interrupted run is left");
    }
}

#[test]
fn a_sweep_killed_at_random_gives_the_same_database() {
    disturb("-KILL", 50);
}

#[test]
fn a_sweep_interrupted_at_random_gives_the_same_database() {
    disturb("-INT", 20);
}

#[test]
fn a_sweep_records_every_status_and_brackets_the_limit() {
    let root = tempfile::tempdir().unwrap();
    undisturbed(root.path());
    let database = Database::open(root.path()).unwrap();
    let entries = database.entries().unwrap();
    let steady = entries.iter().filter(|entry| entry.status.is_steady()).count();
    assert!(steady > 2 && steady < entries.len(), "{steady} of {}", entries.len());
    for entry in &entries {
        let trajectory = database.read(&entry.parameters).unwrap();
        match entry.status {
            Status::Steady { time } => assert!(trajectory.times.contains(&time)),
            Status::Unsteady => assert_eq!(trajectory.times, database.times()),
            Status::Stopped { time, .. } => assert!(trajectory.times.iter().all(|t| *t <= time)),
        }
    }
    let limits = succeed(&format!("fom limit --json --database {}", root.path().display()));
    let limits: serde_json::Value = serde_json::from_str(&limits).unwrap();
    for row in limits["limits"].as_array().unwrap() {
        let of = |name: &str| row[name].as_f64().unwrap();
        let (below, above) = (of("largest_steady_ca"), of("smallest_unsteady_ca"));
        assert!(above > below && above - below <= 0.008, "{row}");
        assert_eq!(of("limit"), 0.5 * (below + above));
    }
}

#[test]
fn shards_merge_to_the_database_of_one_sweep() {
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    let design = "--ca 0.05,0.1 --confinement 0.75,0.8,0.85";
    succeed(&sweep(&at("whole"), design));
    for part in 1..=2 {
        succeed(&sweep(&at(&part.to_string()), &format!("{design} --shard {part}/2")));
    }
    let merge = |parts: &[&str], out: &str, design: &str| {
        let parts: Vec<String> = parts.iter().map(|part| at(part).display().to_string()).collect();
        format!(
            "database merge --out {} {} {design}",
            at(out).display(),
            parts.join(" ")
        )
    };
    fails(&merge(&["1"], "merged", design), 1, &["not complete", "is missing"]);
    assert!(!at("merged").exists());
    let report = succeed(&merge(&["1", "2", "1"], "merged", design));
    let whole = files(&at("whole"));
    // Two files are not configurations.
    assert!(
        report.starts_with(&format!("{} configurations of 3 databases", whole.len() - 2)),
        "{report}"
    );
    assert!(files(&at("merged")) == whole);

    fails(&merge(&["1", "2"], "merged", ""), 1, &["merged", "not empty"]);
    fails(&merge(&[], "none", ""), 2, &["DIR"]);
    fails(&merge(&["1", "nowhere"], "none", ""), 1, &["nowhere", "database.json"]);
    succeed(&sweep(
        &at("other"),
        &format!("{design} --shard 2/2 --snapshot-interval 0.4"),
    ));
    fails(
        &merge(&["1", "other"], "none", ""),
        1,
        &["solver.snapshot_interval", "0.2", "0.4"],
    );
    fails(&sweep(&at("other"), design), 1, &["other", "solver.snapshot_interval"]);
}

#[test]
fn impossible_sweeps_are_named_before_anything_is_written() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("none");
    let fails = |more: &str, code, words: &[&str]| {
        fails(
            &format!("fom sweep --database {} {more}", folder.display()),
            code,
            words,
        )
    };
    fails("--ca 0 --confinement 0.9", 1, &["capillary number", "positive"]);
    fails("--ca -0.1 --confinement 0.9", 1, &["capillary number", "-0.1"]);
    fails("--ca NaN --confinement 0.9", 1, &["capillary number", "NaN"]);
    fails("--ca 0.1 --confinement -1", 1, &["confinement", "-1"]);
    fails("--mesh 1", 1, &["mesh frequency 1", "2 to"]);
    fails("--mesh 2 --ca 0.1 --confinement 0.9,3", 1, &["a/l = 3", "below"]);
    fails("--shard 3/2", 2, &["3/2", "1 <= i <= n"]);
    fails("--shard 0/2", 2, &["0/2"]);
    fails("--workers 0", 1, &["--workers"]);
    fails("--bracket -1", 1, &["--bracket"]);
    fails("--bracket NaN", 1, &["--bracket"]);
    fails("--design paper --ca 0.1", 2, &["--design"]);
    fails("--end-time 0", 1, &["end time"]);
    assert!(!folder.exists());
    fails(
        "--mesh 2 --ca 0.1 --confinement 0.9 --integrator ralston --step 0.1",
        1,
        &["Ca = 0.1, a/l = 0.9", "unstable", "limit"],
    );
}

#[test]
fn limits_of_what_is_no_database_are_refused() {
    fails(
        "fom limit --database no/such/folder",
        1,
        &["no/such/folder", "database.json"],
    );
}

/// A small file system that is unmounted with the test.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(folder: &Path, size: &str) -> Option<Self> {
        std::fs::create_dir(folder).ok()?;
        let options = format!("size={size}");
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", &options, "tmpfs"]).arg(folder);
        let mounted = mount
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success());
        mounted.then(|| SmallDisk(folder.to_path_buf()))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[test]
fn a_full_disk_is_an_error_with_nothing_half_written() {
    let root = tempfile::tempdir().unwrap();
    let (expected, _) = undisturbed(&root.path().join("undisturbed"));
    let Some(disk) = SmallDisk::mount(&root.path().join("disk"), "48k") else {
        println!("LEFT OUT: mounting a small file system needs root");
        return;
    };
    let folder = disk.0.join("database");
    fails(&sweep(&folder, DESIGN), 1, &["disk/database", "No space left"]);
    let found = files(&folder);
    assert!(!found.is_empty() && found.len() < expected.len());
    for (name, bytes) in &found {
        assert!(expected[name] == *bytes, "{name} is whole");
    }
    let hidden = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    let hidden: Vec<_> = hidden
        .filter(|name| name.to_string_lossy().starts_with(".tmp"))
        .collect();
    assert!(hidden.is_empty(), "{hidden:?}");

    // With room it goes on.
    let resized = Command::new("mount")
        .args(["-o", "remount,size=4m"])
        .arg(&disk.0)
        .status();
    assert!(resized.unwrap().success());
    succeed(&sweep(&folder, DESIGN));
    assert!(files(&folder) == expected);
}
