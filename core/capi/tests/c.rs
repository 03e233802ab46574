//! The archives of `cargo xtask package`, used as a C programmer would: every example is built by gcc and by clang,
//! runs under valgrind and under sanitizers, and says the same on emulated machines. The environment names the folder
//! of the archives' folders (CAPSULE_PACKAGES), the target of this machine (CAPSULE_HOST), and the targets whose
//! machines are emulated (CAPSULE_TARGETS, separated by spaces): `cargo xtask test --only c` and
//! `cargo xtask package --check` set it.

#[path = "../../tests/suite/common/mod.rs"]
mod common;

use capsule_core::{Evaluator, Method, Model, Query, Workspace};
use std::path::{Path, PathBuf};
use std::process::Command;

const EXAMPLES: [&str; 5] = ["quick_start", "instrument", "two_models", "slices", "static_buffers"];
/// The libraries: with both methods, and without the paper's.
const LIBRARIES: [&str; 2] = ["lib/libcapsule.a", "lib/libcapsule_direct.a"];
/// Output of a program for the second.
const DIRECT: &str = "-DCAPSULE_DIRECT";
const STRICT: [&str; 5] = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// An emulated machine.
struct Machine {
    name: &'static str,
    /// Of its archive.
    target: &'static str,
    compiler: &'static str,
    /// Of the compiler, in the folder of the archive.
    options: [&'static str; 2],
    /// The command that runs a program, without the program.
    emulator: [&'static str; 2],
}

/// The board that QEMU models, and the calls of the C library that QEMU answers, its output on standard output.
const BOARD: &str = "-mthumb --specs=rdimon.specs -T examples/cortex-m/mps2.ld examples/cortex-m/start.c";
const SEMIHOSTING: &str = "-display none -serial none -monitor none \
     -chardev stdio,id=out -semihosting-config enable=on,target=native,chardev=out -kernel";

const MACHINES: [Machine; 6] = [
    Machine {
        name: "cortex-m4f",
        target: "thumbv7em-none-eabihf",
        compiler: "arm-none-eabi-gcc",
        options: ["-mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16", BOARD],
        emulator: ["qemu-system-arm -M mps2-an386 -cpu cortex-m4", SEMIHOSTING],
    },
    Machine {
        name: "cortex-m7",
        target: "thumbv7em-none-eabihf",
        compiler: "arm-none-eabi-gcc",
        options: [
            "-mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-sp-d16 -Wl,--defsym=EXTERNAL=0x60000000",
            BOARD,
        ],
        emulator: ["qemu-system-arm -M mps2-an500 -cpu cortex-m7", SEMIHOSTING],
    },
    Machine {
        name: "cortex-m33",
        target: "thumbv8m.main-none-eabihf",
        compiler: "arm-none-eabi-gcc",
        options: [
            "-mcpu=cortex-m33 -mfloat-abi=hard -mfpu=fpv5-sp-d16 \
             -Wl,--defsym=EXTERNAL=0x80000000,--defsym=CODE=0x10000000,--defsym=DATA=0x38000000",
            BOARD,
        ],
        emulator: ["qemu-system-arm -M mps2-an505 -cpu cortex-m33", SEMIHOSTING],
    },
    Machine {
        name: "cortex-m4",
        target: "thumbv7em-none-eabi",
        compiler: "arm-none-eabi-gcc",
        options: ["-mcpu=cortex-m4 -mfloat-abi=soft", BOARD],
        emulator: ["qemu-system-arm -M mps2-an386 -cpu cortex-m4", SEMIHOSTING],
    },
    Machine {
        name: "rv32imac",
        target: "riscv32imac-unknown-none-elf",
        compiler: "riscv64-unknown-elf-gcc",
        options: [
            "-march=rv32imac -mabi=ilp32 --specs=picolibc.specs --oslib=semihost --crt0=hosted",
            "-Wl,--defsym=__flash=0x80000000,--defsym=__flash_size=4M,--defsym=__ram=0x80400000,--defsym=__ram_size=4M",
        ],
        emulator: ["qemu-system-riscv32 -M virt -bios none", SEMIHOSTING],
    },
    Machine {
        name: "aarch64",
        target: "aarch64-unknown-linux-gnu",
        compiler: "aarch64-linux-gnu-gcc",
        options: ["-static", ""],
        emulator: ["qemu-aarch64", ""],
    },
];

fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_else(|_| panic!("{name} is not set: `cargo xtask test --only c`"))
}

/// The folder of an archive.
fn package(target: &str) -> PathBuf {
    let name = format!("capsule-rom-{}-{target}", env!("CARGO_PKG_VERSION"));
    Path::new(&variable("CAPSULE_PACKAGES")).join(name)
}

fn host_package() -> PathBuf {
    package(&variable("CAPSULE_HOST"))
}

/// A command that is written with spaces between its words.
fn command(line: &[&str]) -> Command {
    let mut words = line.iter().flat_map(|part| part.split_whitespace());
    let mut command = Command::new(words.next().expect("a program"));
    command.args(words);
    command
}

/// Output of a program, which must succeed.
fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Builds an example of a package; returns the program.
fn build(compiler: &str, options: &[&str], package: &Path, example: &str, name: &str) -> PathBuf {
    let [both, direct] = LIBRARIES;
    let library = if options.contains(&DIRECT) { direct } else { both };
    build_with(library, compiler, options, package, example, name)
}

/// Builds an example of a package with a library.
fn build_with(library: &str, compiler: &str, options: &[&str], package: &Path, example: &str, name: &str) -> PathBuf {
    // A second model that is not the first.
    let second = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("family-{name}-{example}.crom"));
    std::fs::write(&second, common::Family::new(3).file()).unwrap();
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{example}-{name}"));
    run(Command::new(compiler)
        .current_dir(package)
        .args(STRICT)
        .args(options)
        .args(["-Iinclude", "-DMODEL=\"models/capsule.crom\""])
        .arg(format!("-DSECOND_MODEL=\"{}\"", second.display()))
        .arg(format!("examples/{example}.c"))
        .args(["examples/model.S", library, "-Wl,--gc-sections"])
        .arg("-o")
        .arg(&program));
    program
}

fn on_host(compiler: &str, options: &[&str], example: &str, name: &str) -> PathBuf {
    build(compiler, options, &host_package(), example, name)
}

/// Output of the example without a debugger.
fn said(example: &str, name: &str) -> String {
    run(&mut Command::new(on_host("gcc", &["-O2"], example, name)))
}

#[test]
fn gcc_and_clang_and_what_the_core_answers() {
    for example in EXAMPLES {
        let by_clang = run(&mut Command::new(on_host("clang", &["-O2"], example, "clang")));
        assert_eq!(said(example, "gcc"), by_clang, "{example}");
    }
    let file = std::fs::read(host_package().join("models/capsule.crom")).unwrap();
    let model = Model::open(&file).unwrap();
    let mut workspace = Workspace::<f32>::new();
    let mut evaluator = Evaluator::new(&model, &mut workspace).unwrap();
    let method: Method = model.default_method();
    evaluator.prepare(&Query::new([0.10, 0.90], method)).unwrap();
    let length = evaluator.at(3.0).unwrap().observables().unwrap().axial_length;
    let text = said("quick_start", "again");
    assert!(
        text.starts_with(concat!("capsule-rom ", env!("CARGO_PKG_VERSION"), ",")),
        "{text}"
    );
    let printed = text
        .split("length ")
        .nth(1)
        .and_then(|rest| rest.split(',').next())
        .unwrap();
    assert_eq!(printed.parse::<f32>().unwrap().to_bits(), length.to_bits(), "{text}");
}

#[test]
fn valgrind_finds_nothing() {
    for example in EXAMPLES {
        let program = on_host("gcc", &["-O1", "-g"], example, "valgrind");
        let watched = run(Command::new("valgrind")
            .args(["--quiet", "--error-exitcode=9", "--leak-check=full"])
            .arg(program));
        assert_eq!(watched, said(example, "beside-valgrind"), "{example}");
    }
}

#[test]
fn sanitizers_find_nothing() {
    for example in EXAMPLES {
        let options = ["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
        let watched = run(&mut Command::new(on_host("gcc", &options, example, "sanitized")));
        assert_eq!(watched, said(example, "beside-sanitizers"), "{example}");
    }
}

#[test]
fn without_the_paper_s_method_the_rest_is_the_same() {
    let [both, _] = LIBRARIES;
    let quick_start = on_host("gcc", &["-O2", DIRECT], "quick_start", "direct");
    assert_eq!(
        run(&mut Command::new(quick_start)),
        said("quick_start", "beside-direct")
    );
    // The example asks for the paper's method.
    let slices = on_host("gcc", &["-O2", DIRECT], "slices", "direct");
    let refused = Command::new(slices).output().unwrap();
    let text = [refused.stdout, refused.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    assert!(
        !refused.status.success() && text.contains("local displacement modes"),
        "{text}"
    );
    // A workspace for the one library is too small for the other, which says so.
    let package = host_package();
    let mixed = build_with(both, "gcc", &["-O2", DIRECT], &package, "quick_start", "mixed");
    let refused = Command::new(mixed).output().unwrap();
    let text = [refused.stdout, refused.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    assert!(!refused.status.success() && text.contains("12624"), "{text}");
}

#[test]
fn the_header_is_good_for_other_languages() {
    let include = format!("-I{}", host_package().join("include").display());
    let source = Path::new(env!("CARGO_TARGET_TMPDIR")).join("header.inc");
    std::fs::write(&source, "#include <capsule.h>\ncapsule_workspace workspace;\n").unwrap();
    for words in [
        ["gcc", "-std=c99", "-xc"],
        ["clang", "-std=c2x", "-xc"],
        ["g++", "-std=c++11", "-xc++"],
    ] {
        run(Command::new(words[0])
            .args(["-Wall", "-Wextra", "-Werror", "-fsyntax-only", &include])
            .args(&words[1..])
            .arg(&source));
    }
}

/// Runs the C++ example of a host's package, built by a compiler with some options.
fn cpp_output(compiler: &str, options: &[&str]) -> String {
    let package = host_package();
    let (target, object) = (Path::new(env!("CARGO_TARGET_TMPDIR")), format!("model-{compiler}.o"));
    let (program, object) = (target.join(format!("quick_start-{compiler}")), target.join(object));
    run(Command::new("gcc")
        .arg(format!("-DMODEL=\"{}\"", package.join("models/capsule.crom").display()))
        .arg("-c")
        .arg(package.join("examples/model.S"))
        .arg("-o")
        .arg(&object));
    run(Command::new(compiler)
        .args(["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror"])
        .args(options)
        .arg(format!("-I{}", package.join("include").display()))
        .arg(package.join("examples/quick_start.cpp"))
        .arg(object)
        .arg(package.join(LIBRARIES[0]))
        .arg("-o")
        .arg(&program));
    run(&mut Command::new(program))
}

#[test]
fn cpp_answers_as_c_does() {
    let text = cpp_output("g++", &["-O2"]);
    assert_eq!(text, cpp_output("clang++", &["-O1", "-fsanitize=address,undefined"]));
    let shape = text.lines().next().unwrap();
    assert!(said("quick_start", "beside-cpp").contains(shape), "{text}");
    // A refused query arrives as an exception with its figures.
    assert!(
        text.contains("no steady state exists") && text.contains("found 0.15"),
        "{text}"
    );
}

#[test]
fn the_cpp_header_needs_no_exceptions() {
    let include = format!("-I{}", host_package().join("include").display());
    let source = Path::new(env!("CARGO_TARGET_TMPDIR")).join("header.cpp");
    std::fs::write(&source, "#include <capsule.hpp>\ncapsule::Workspace workspace;\n").unwrap();
    for option in ["-fno-exceptions", "-fno-rtti"] {
        run(Command::new("g++")
            .args([
                "-std=c++17",
                "-Wall",
                "-Wextra",
                "-Werror",
                "-fsyntax-only",
                &include,
                option,
            ])
            .arg(&source));
    }
}

/// A directory in the tests' target directory, empty.
fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn build_systems_find_the_package() {
    let package = host_package();
    let folder = empty_folder("cmake");
    std::fs::write(
        folder.join("CMakeLists.txt"),
        format!(
            "cmake_minimum_required(VERSION 3.18)\nproject(user LANGUAGES C CXX ASM)\n\
             find_package(capsule 0.1 REQUIRED)\n\
             add_executable(user {0}/examples/quick_start.cpp {0}/examples/model.S)\n\
             target_compile_definitions(user PRIVATE MODEL=\"{0}/models/capsule.crom\")\n\
             target_link_libraries(user PRIVATE capsule::capsule)\n\
             add_executable(direct {0}/examples/quick_start.c {0}/examples/model.S)\n\
             target_compile_definitions(direct PRIVATE MODEL=\"{0}/models/capsule.crom\")\n\
             target_link_libraries(direct PRIVATE capsule::direct)\n",
            package.display()
        ),
    )
    .unwrap();
    run(Command::new("cmake")
        .arg(format!("-DCMAKE_PREFIX_PATH={}", package.display()))
        .arg("-S")
        .arg(&folder)
        .arg("-B")
        .arg(folder.join("build")));
    run(Command::new("cmake").arg("--build").arg(folder.join("build")));
    let shape = run(&mut Command::new(folder.join("build/user")));
    let shape = shape.lines().next().unwrap();
    for program in [
        folder.join("build/direct"),
        on_host("gcc", &["-O2"], "quick_start", "beside-cmake"),
    ] {
        assert!(run(&mut Command::new(program)).contains(shape), "{shape}");
    }
    let flags = run(Command::new("pkg-config")
        .env("PKG_CONFIG_PATH", package.join("lib/pkgconfig"))
        .args(["--cflags", "--libs", "capsule"]));
    for (option, path) in flags.split_whitespace().filter_map(|word| word.split_at_checked(2)) {
        if option == "-I" || option == "-L" {
            assert!(Path::new(path).is_dir(), "{flags}");
        }
    }
    assert!(flags.contains("-lcapsule"), "{flags}");
}

#[test]
fn the_examples_say_the_same_on_every_machine() {
    let targets = variable("CAPSULE_TARGETS");
    for target in targets
        .split_whitespace()
        .filter(|target| *target != variable("CAPSULE_HOST"))
    {
        let machines: Vec<_> = MACHINES.iter().filter(|machine| machine.target == target).collect();
        assert!(!machines.is_empty(), "no machine runs {target}");
        for machine in machines {
            let options: Vec<&str> = machine
                .options
                .iter()
                .flat_map(|part| part.split_whitespace())
                .collect();
            let options = [&["-O2"], &options[..]].concat();
            let direct = [&options[..], &[DIRECT]].concat();
            let examples = EXAMPLES.map(|example| (example, &options));
            for (example, options) in examples.into_iter().chain([("quick_start", &direct)]) {
                let program = build(machine.compiler, options, &package(target), example, machine.name);
                let printed = run(command(&machine.emulator).arg(program));
                assert_eq!(
                    printed,
                    said(example, &format!("beside-{}", machine.name)),
                    "{example} on {}",
                    machine.name
                );
            }
        }
    }
}

#[test]
fn the_archives_use_the_instructions_of_their_processors() {
    let least = [("sxtb16", 2), ("smlad", 2), ("vsqrt.f32", 1)];
    for (target, least) in [
        ("thumbv7em-none-eabihf", &least[..]),
        ("thumbv8m.main-none-eabihf", &least),
        // No floating-point unit.
        ("thumbv7em-none-eabi", &least[..2]),
    ] {
        for library in LIBRARIES {
            let code = run(Command::new("arm-none-eabi-objdump")
                .args(["--disassemble", "--no-show-raw-insn"])
                .arg(package(target).join(library)));
            // Two rows of two columns take two of each; the square root is called from everywhere.
            for (instruction, least) in least {
                let found = code.matches(&format!("\t{instruction}\t")).count();
                assert!(found >= *least, "{target}, {library}: {found} times {instruction}");
            }
        }
    }
}
