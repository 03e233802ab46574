//! Commands of the pages: the subcommands and options of `capsule-rom` and `cargo xtask` that they name must exist.

use super::page::Page;
use crate::command::{command, output, run};
use crate::target_directory;
use anyhow::{Context, Result};
use std::collections::BTreeMap;

/// A command as a page has it.
#[derive(Clone, Debug, PartialEq)]
struct Use {
    /// `capsule-rom` or `xtask`, and its subcommands.
    words: Vec<String>,
    options: Vec<String>,
}

/// Commands that do not exist, or not with these options.
pub fn faults(pages: &[Page]) -> Result<Vec<String>> {
    // As a dependency of a test: the features, and so the builds, are those of the other stages.
    run(&mut command("cargo test --quiet --workspace --test command --no-run"))?;
    let mut helps: BTreeMap<Vec<String>, Option<String>> = BTreeMap::new();
    let mut faults = Vec::new();
    // The changelog names commands of other versions.
    for page in pages.iter().filter(|page| !page.path().ends_with("CHANGELOG.md")) {
        for (number, text) in lines(page.text()) {
            for Use { words, options } in uses(&text) {
                if !helps.contains_key(&words) {
                    helps.insert(words.clone(), help(&words)?);
                }
                let line = words.join(" ");
                match helps.get(&words).and_then(Option::as_deref) {
                    None => faults.push(page.fault(number, &format!("there is no command `{line}`"))),
                    Some(help) => {
                        let missing = options.iter().filter(|option| !has(help, option));
                        faults.extend(missing.map(|option| page.fault(number, &format!("`{line}` has no {option}"))));
                    }
                }
            }
        }
    }
    Ok(faults)
}

/// The help text of a command, if the command exists.
fn help(words: &[String]) -> Result<Option<String>> {
    let (program, subcommands) = words.split_first().context("a command without words")?;
    let program = match program.as_str() {
        "xtask" => std::env::current_exe()?,
        _ => target_directory().join("debug/capsule-rom"),
    };
    let mut ask = command(&program.to_string_lossy());
    let known = ask.args(subcommands).arg("--help").output()?.status.success();
    if known { Ok(Some(output(&mut ask)?)) } else { Ok(None) }
}

/// Whether a help text describes an option.
fn has(help: &str, option: &str) -> bool {
    let word = |c: char| !(c.is_alphanumeric() || c == '-');
    help.split(word).any(|found| found == option)
}

/// Lines of fenced code and of code spans, with their numbers; one that ends with a backslash goes on in the next.
fn lines(text: &str) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let (mut continues, mut fenced) = (false, false);
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
            continue;
        }
        let spans: Vec<&str> = line.split('`').skip(1).step_by(2).collect();
        match lines.last_mut() {
            Some((_, last)) if continues => last.push_str(line),
            _ if fenced => lines.push((number, line.to_owned())),
            _ => lines.extend(spans.into_iter().map(|span| (number, span.to_owned()))),
        }
        continues = fenced && line.ends_with('\\');
        if continues && let Some((_, last)) = lines.last_mut() {
            last.pop();
        }
    }
    lines
}

/// The commands of a line of a shell.
fn uses(line: &str) -> Vec<Use> {
    let mut uses = Vec::new();
    for part in line.split([';', '|', '&', '#', '(', ')']) {
        let mut words = part
            .split_whitespace()
            .skip_while(|word| !["capsule-rom", "xtask"].contains(word));
        let Some(program) = words.next() else {
            continue;
        };
        let mut found = Use {
            words: vec![program.to_owned()],
            options: Vec::new(),
        };
        let mut named = false;
        for word in words {
            let option = word.split('=').next().unwrap_or_default();
            named |= option.starts_with('-');
            if option.starts_with("--") && option.len() > 2 {
                found.options.push(option.to_owned());
            }
            let subcommand = word.chars().all(|c| c.is_ascii_lowercase() || c == '-');
            if !named && subcommand && found.words.len() < 3 {
                found.words.push(word.to_owned());
            } else {
                named = true;
            }
        }
        uses.push(found);
    }
    uses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_found_with_their_options() {
        let found = |line: &str| {
            let uses = uses(line).into_iter();
            uses.map(|found| format!("{} {}", found.words.join("."), found.options.join(",")))
                .collect::<Vec<_>>()
        };
        let line = "for x in 1; do capsule-rom fom run --ca $ca --mesh 5 --out=DIR; done  # capsule-rom predict --t 1";
        assert_eq!(
            found(line),
            ["capsule-rom.fom.run --ca,--mesh,--out", "capsule-rom.predict --t"]
        );
        assert_eq!(found("cargo xtask test --only a,b"), ["xtask.test --only"]);
        assert_eq!(
            found("capsule-rom completions bash > file"),
            ["capsule-rom.completions.bash "]
        );
        assert_eq!(found("ls capsule.crom"), [""; 0]);
    }

    #[test]
    fn fenced_lines_and_code_spans_are_read_and_go_on_after_a_backslash() {
        let text = "x `d` y `e f`\n```sh\na \\\n b\nc\n```\n";
        let found = lines(text);
        let expected = [(1, "d"), (1, "e f"), (3, "a  b"), (5, "c")];
        assert_eq!(found, expected.map(|(number, line)| (number, line.to_owned())));
    }

    #[test]
    fn an_option_is_a_whole_word() {
        let help = "  --plot <FILE>  Plot\n  -t, --tolerance=<T>";
        assert_eq!(
            ["--plot", "--tolerance", "--plots", "--tol"].map(|option| has(help, option)),
            [true, true, false, false]
        );
    }
}
