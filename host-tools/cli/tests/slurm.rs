//! The batch script of a sweep on a Slurm of one node, which the test starts on loopback.
//!
//! `cargo xtask test --only cluster` installs Slurm (Debian, as root) and runs it; without Slurm it says so and passes.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A daemon that ends with the test.
struct Daemon(Child);

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = Command::new("kill").arg(self.0.id().to_string()).status();
        let deadline = Instant::now() + Duration::from_secs(20);
        while Instant::now() < deadline {
            if !matches!(self.0.try_wait(), Ok(None)) {
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A Slurm of one node. The daemons end in this order.
struct Slurm {
    _node: Daemon,
    _controller: Daemon,
    _authentication: Daemon,
    configuration: PathBuf,
}

fn succeeds(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

fn text(command: &mut Command) -> String {
    let output = command.output().expect("the command starts");
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

/// Why the test cannot run, if it cannot.
fn missing() -> Option<&'static str> {
    let there = |program: &str| succeeds(Command::new("sh").args(["-c", &format!("command -v {program}")]));
    if text(Command::new("id").arg("-u")) != "0" {
        return Some("the daemons need root");
    }
    let all = ["munged", "slurmctld", "slurmd", "sbatch"].into_iter().all(there);
    (!all).then_some("Slurm is missing; `cargo xtask test --only cluster` installs it")
}

fn wait_for(what: &str, mut done: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(120);
    while !done() {
        assert!(Instant::now() < deadline, "{what} takes too long");
        std::thread::sleep(Duration::from_millis(200));
    }
}

impl Slurm {
    fn start(folder: &Path) -> Self {
        // Both are bound at once, so that they differ.
        let listeners = [0; 2].map(|_| TcpListener::bind("127.0.0.1:0").expect("a free port"));
        let ports = listeners
            .each_ref()
            .map(|l| l.local_addr().expect("its address").port());
        drop(listeners);
        let at = |name: &str| folder.join(name).display().to_string();
        let key: Vec<u8> = (0..=255).collect();
        std::fs::write(at("munge.key"), key).unwrap();
        assert!(succeeds(Command::new("chmod").args(["600", &at("munge.key")])));
        for folder in ["controller", "node"] {
            std::fs::create_dir(at(folder)).unwrap();
        }
        let settings = [
            ("ClusterName", "loopback".to_owned()),
            ("SlurmctldHost", "localhost(127.0.0.1)".to_owned()),
            ("SlurmctldPort", ports[0].to_string()),
            ("SlurmdPort", ports[1].to_string()),
            ("SlurmUser", "root".to_owned()),
            ("AuthType", "auth/munge".to_owned()),
            ("AuthInfo", format!("socket={}", at("munge.socket"))),
            ("ProctrackType", "proctrack/linuxproc".to_owned()),
            ("TaskPlugin", "task/none".to_owned()),
            ("SelectType", "select/cons_tres".to_owned()),
            ("SelectTypeParameters", "CR_CPU".to_owned()),
            ("SchedulerParameters", "batch_sched_delay=0,sched_interval=1".to_owned()),
            ("MpiDefault", "none".to_owned()),
            ("ReturnToService", "2".to_owned()),
            ("SlurmdParameters", "config_overrides".to_owned()),
            ("StateSaveLocation", at("controller")),
            ("SlurmdSpoolDir", at("node")),
            ("SlurmctldPidFile", at("controller.pid")),
            ("SlurmdPidFile", at("node.pid")),
            (
                "NodeName",
                "localhost NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN".to_owned(),
            ),
            ("PartitionName", "all Nodes=ALL Default=YES State=UP".to_owned()),
        ];
        let settings: String = settings.map(|(name, value)| format!("{name}={value}\n")).concat();
        let configuration = folder.join("slurm.conf");
        std::fs::write(&configuration, settings).unwrap();

        let daemon = |log: &str, program: &str, arguments: &[String]| {
            let log = std::fs::File::create(at(log)).unwrap();
            let mut command = Command::new(program);
            command.args(arguments).env("SLURM_CONF", &configuration);
            command
                .stdin(Stdio::null())
                .stdout(log.try_clone().unwrap())
                .stderr(log);
            Daemon(command.spawn().expect("the daemon starts"))
        };
        let option = |name: &str, file: &str| format!("--{name}={}", at(file));
        let munge = [
            "--foreground".to_owned(),
            "--force".to_owned(),
            option("key-file", "munge.key"),
            option("socket", "munge.socket"),
            option("pid-file", "munge.pid"),
            option("log-file", "munge.log"),
            option("seed-file", "munge.seed"),
        ];
        let authentication = daemon("munge.out", "munged", &munge);
        wait_for("munged", || folder.join("munge.socket").exists());
        let slurm = Slurm {
            _authentication: authentication,
            _controller: daemon("controller.out", "slurmctld", &["-D".to_owned()]),
            _node: daemon("node.out", "slurmd", &["-D", "-N", "localhost"].map(str::to_owned)),
            configuration,
        };
        wait_for("the node", || {
            text(slurm.client("sinfo").args(["-h", "-o", "%T"])) == "idle"
        });
        slurm
    }

    fn client(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", &self.configuration);
        command
    }
}

const DESIGN: &str = "--ca 0.05,0.1 --confinement 0.75,0.8,0.85";
const SETTINGS: &str = "--mesh 2 --end-time 0.2";

fn digest(folder: &Path) -> u64 {
    capsule_database::Database::open(folder).unwrap().digest().unwrap()
}

#[test]
fn a_job_array_makes_the_database_of_one_sweep() {
    if let Some(reason) = missing() {
        println!("LEFT OUT: {reason}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let program = env!("CARGO_BIN_EXE_capsule-rom");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("cluster/sweep.sbatch");
    let slurm = Slurm::start(folder.path());
    let submit = || {
        let mut command = slurm.client("sh");
        command.arg(&script).args(SETTINGS.split_whitespace());
        // As in an interactive allocation, here within an array of another program.
        command.env("SLURM_JOB_ID", "7").env("SLURM_ARRAY_TASK_ID", "9");
        command
            .env("PARTS", "2")
            .env("DESIGN", DESIGN)
            .env("CAPSULE_ROM", program);
        let answer = text(command.env("FOLDER", at("sweep")).current_dir(folder.path()));
        let job = answer.rsplit(' ').next().unwrap_or_default().to_owned();
        assert!(job.parse::<u32>().is_ok(), "no job: {answer}");
        let state = || {
            let job = text(slurm.client("scontrol").args(["--oneliner", "show", "job", &job]));
            let state = job.split_whitespace().find_map(|word| word.strip_prefix("JobState="));
            state.unwrap_or_default().to_owned()
        };
        wait_for("the sweep", || {
            !["PENDING", "RUNNING", "COMPLETING"].contains(&state().as_str())
        });
        let logs = std::fs::read_dir(at("sweep/logs")).unwrap();
        let logs = logs.map(|log| std::fs::read_to_string(log.unwrap().path()).unwrap_or_default());
        (state(), logs.collect::<Vec<String>>().join("\n"))
    };
    let (state, logs) = submit();
    assert_eq!(state, "COMPLETED", "{logs}");

    let mut alone = Command::new(program);
    alone.args(["fom", "sweep", "--quiet", "--database"]).arg(at("alone"));
    alone.args(DESIGN.split_whitespace()).args(SETTINGS.split_whitespace());
    assert!(succeeds(&mut alone));
    assert_eq!(digest(&at("sweep/database")), digest(&at("alone")));
    for part in ["1", "2"] {
        let part = capsule_database::Database::open(&at("sweep/parts").join(part)).unwrap();
        assert!(!part.entries().unwrap().is_empty(), "each job had a part");
    }

    // A second merge would overwrite: its job fails and says why.
    let (state, logs) = submit();
    assert!(state == "FAILED" && logs.contains("is not empty"), "{state}: {logs}");
}
