//! The batch script of a sweep with a stand-in for Slurm, which answers as a federation of clusters does.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Writes what it is called with, a line a call, and answers with a job and its cluster.
const SBATCH: &str = "#!/bin/sh\necho \"$*\" >> \"$CALLS\"\necho '77;south'\n";

fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cluster/sweep.sbatch")
}

/// Runs the script with a program that prints its arguments in the place of `capsule-rom`.
fn run(folder: &Path, environment: &[(&str, &str)]) -> Output {
    let sbatch = folder.join("sbatch");
    std::fs::write(&sbatch, SBATCH).unwrap();
    std::fs::set_permissions(&sbatch, PermissionsExt::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("sh");
    command.arg(script()).args(["--mesh", "13"]).env("PATH", path);
    command.env("CALLS", folder.join("calls")).env("FOLDER", folder);
    command
        .env("PARTS", "3")
        .env("DESIGN", "--ca 0.05,0.1")
        .env("CAPSULE_ROM", "echo");
    command.envs(environment.iter().copied()).output().unwrap()
}

#[test]
fn an_allocation_submits_and_the_cluster_is_cut_off_the_answer() {
    for allocation in [&[][..], &[("SLURM_JOB_ID", "5"), ("SLURM_ARRAY_TASK_ID", "2")]] {
        let folder = tempfile::tempdir().unwrap();
        let output = run(folder.path(), allocation);
        assert!(output.status.success(), "{output:?}");
        let calls = std::fs::read_to_string(folder.path().join("calls")).unwrap();
        let [array, merge] = calls.lines().collect::<Vec<_>>()[..] else {
            panic!("two jobs: {calls}");
        };
        let of = |call: &str, words: &[&str]| {
            assert!(call.ends_with(&format!(" {} --mesh 13", script().display())), "{call}");
            assert!(words.iter().all(|word| call.contains(word)), "{call}");
        };
        of(array, &["--export=ALL,CAPSULE_ROM_JOB=part ", "--array=1-3 "]);
        of(
            merge,
            &["--export=ALL,CAPSULE_ROM_JOB=merge ", "--dependency=afterok:77 "],
        );
        assert!(folder.path().join("logs").is_dir());
    }
}

#[test]
fn a_job_does_its_own_part() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().display();
    std::fs::create_dir_all(folder.path().join("parts/1")).unwrap();
    let said = |environment: &[(&str, &str)]| {
        let output = run(folder.path(), environment);
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let part = said(&[
        ("CAPSULE_ROM_JOB", "part"),
        ("SLURM_ARRAY_TASK_ID", "2"),
        ("SLURM_CPUS_PER_TASK", "4"),
    ]);
    assert_eq!(
        part,
        format!("fom sweep --database {root}/parts/2 --ca 0.05,0.1 --shard 2/3 --workers 4 --mesh 13\n")
    );
    // The number of a part may be left over from where it was submitted.
    let merge = said(&[("CAPSULE_ROM_JOB", "merge"), ("SLURM_ARRAY_TASK_ID", "2")]);
    assert_eq!(
        merge,
        format!("database merge --out {root}/database --ca 0.05,0.1 {root}/parts/1\n")
    );
    assert_eq!(
        run(folder.path(), &[("CAPSULE_ROM_JOB", "other")]).status.code(),
        Some(2)
    );
    assert!(!folder.path().join("calls").exists());
}
