//! The archives of `cargo xtask package`, used as a C programmer would: every example is built by gcc and by clang,
//! runs under valgrind and under sanitizers, and says the same on an emulated Cortex-M4F, M7 and M33. The folders of
//! the archives are in the environment variables CAPSULE_HOST_PACKAGE, CAPSULE_CORTEX_M_PACKAGE and
//! CAPSULE_CORTEX_M33_PACKAGE: `cargo xtask test --only c`.

#[path = "../../tests/suite/common/mod.rs"]
mod common;

use capsule_core::{Evaluator, Method, Model, Query, Workspace};
use std::path::{Path, PathBuf};
use std::process::Command;

const EXAMPLES: [&str; 4] = ["quick_start", "instrument", "two_models", "slices"];
/// The libraries: with both methods, and without the paper's.
const LIBRARIES: [&str; 2] = ["lib/libcapsule.a", "lib/libcapsule_direct.a"];
/// Output of a program for the second.
const DIRECT: &str = "-DCAPSULE_DIRECT";
const STRICT: [&str; 5] = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// A Cortex-M, its compiler's words, its archive and its board.
struct Board {
    cpu: &'static str,
    fpu: &'static str,
    /// The variable that says where the archive is.
    package: &'static str,
    machine: &'static str,
    /// Where its memory starts.
    memory: &'static str,
}

const BOARDS: [Board; 3] = [
    Board {
        cpu: "cortex-m4",
        fpu: "fpv4-sp-d16",
        package: "CAPSULE_CORTEX_M_PACKAGE",
        machine: "mps2-an386",
        memory: "--defsym=EXTERNAL=0x21000000",
    },
    Board {
        cpu: "cortex-m7",
        fpu: "fpv5-sp-d16",
        package: "CAPSULE_CORTEX_M_PACKAGE",
        machine: "mps2-an500",
        memory: "--defsym=EXTERNAL=0x60000000",
    },
    Board {
        cpu: "cortex-m33",
        fpu: "fpv5-sp-d16",
        package: "CAPSULE_CORTEX_M33_PACKAGE",
        machine: "mps2-an505",
        memory: "--defsym=EXTERNAL=0x80000000,--defsym=CODE=0x10000000,--defsym=DATA=0x38000000",
    },
];

fn package(variable: &str) -> PathBuf {
    std::env::var_os(variable)
        .unwrap_or_else(|| panic!("{variable} is not set: `cargo xtask test --only c`"))
        .into()
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
fn build(compiler: &str, options: &[&str], package: &Path, example: &str, name: &str, last: &[PathBuf]) -> PathBuf {
    let [both, direct] = LIBRARIES;
    let library = if options.contains(&DIRECT) { direct } else { both };
    build_with(library, compiler, options, package, example, name, last)
}

/// Builds an example of a package with a library.
fn build_with(
    library: &str,
    compiler: &str,
    options: &[&str],
    package: &Path,
    example: &str,
    name: &str,
    last: &[PathBuf],
) -> PathBuf {
    // A second model that is not the first.
    let second = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("family-{name}-{example}.crom"));
    std::fs::write(&second, common::Family::new(3).file()).unwrap();
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{example}-{name}"));
    run(Command::new(compiler)
        .args(STRICT)
        .args(options)
        .arg(format!("-I{}", package.join("include").display()))
        .arg(format!("-DMODEL=\"{}\"", package.join("models/capsule.crom").display()))
        .arg(format!("-DSECOND_MODEL=\"{}\"", second.display()))
        .args([format!("examples/{example}.c"), "examples/model.S".to_owned()].map(|file| package.join(file)))
        .args(last)
        .arg(package.join(library))
        .arg("-Wl,--gc-sections")
        .arg("-o")
        .arg(&program));
    program
}

fn on_host(compiler: &str, options: &[&str], example: &str, name: &str) -> PathBuf {
    build(compiler, options, &package("CAPSULE_HOST_PACKAGE"), example, name, &[])
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
    let file = std::fs::read(package("CAPSULE_HOST_PACKAGE").join("models/capsule.crom")).unwrap();
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
    let package = package("CAPSULE_HOST_PACKAGE");
    let mixed = build_with(both, "gcc", &["-O2", DIRECT], &package, "quick_start", "mixed", &[]);
    let refused = Command::new(mixed).output().unwrap();
    let text = [refused.stdout, refused.stderr].concat();
    let text = String::from_utf8_lossy(&text);
    assert!(!refused.status.success() && text.contains("12624"), "{text}");
}

#[test]
fn the_header_is_good_for_other_languages() {
    let include = format!("-I{}", package("CAPSULE_HOST_PACKAGE").join("include").display());
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
    let package = package("CAPSULE_HOST_PACKAGE");
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
    let include = format!("-I{}", package("CAPSULE_HOST_PACKAGE").join("include").display());
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
    let package = package("CAPSULE_HOST_PACKAGE");
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
fn a_microcontroller_says_the_same() {
    for Board {
        cpu,
        fpu,
        package: variable,
        machine,
        memory,
    } in BOARDS
    {
        let package = package(variable);
        let script = format!("-T{}", package.join("examples/cortex-m/mps2.ld").display());
        let (cpu_option, fpu_option) = (format!("-mcpu={cpu}"), format!("-mfpu={fpu}"));
        let options = [
            "-O2",
            &cpu_option,
            "-mthumb",
            "-mfloat-abi=hard",
            &fpu_option,
            "--specs=rdimon.specs",
            &script,
        ];
        let start = [
            format!("-Wl,{memory}").into(),
            package.join("examples/cortex-m/start.c"),
        ];
        let direct = [&options[..], &[DIRECT]].concat();
        let examples = EXAMPLES.map(|example| (example, &options[..]));
        for (example, options) in examples.into_iter().chain([("quick_start", &direct[..])]) {
            let program = build("arm-none-eabi-gcc", options, &package, example, cpu, &start);
            let printed = run(Command::new("qemu-system-arm")
                .args([
                    "-M", machine, "-cpu", cpu, "-display", "none", "-serial", "none", "-monitor", "none",
                ])
                .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
                .arg(program));
            assert_eq!(printed, said(example, cpu), "{example} on {cpu}");
        }
    }
}

#[test]
fn the_archives_multiply_by_the_dsp_extension() {
    for variable in ["CAPSULE_CORTEX_M_PACKAGE", "CAPSULE_CORTEX_M33_PACKAGE"] {
        for library in LIBRARIES {
            let code = run(Command::new("arm-none-eabi-objdump")
                .args(["--disassemble", "--no-show-raw-insn"])
                .arg(package(variable).join(library)));
            // Two rows of two columns take two of each; the square root is called from everywhere.
            for (instruction, least) in [("sxtb16", 2), ("smlad", 2), ("vsqrt.f32", 1)] {
                let found = code.matches(&format!("\t{instruction}\t")).count();
                assert!(found >= least, "{variable}, {library}: {found} times {instruction}");
            }
        }
    }
}
