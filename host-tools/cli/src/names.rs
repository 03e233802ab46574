//! Numbers by name, as the command line gives them: `NAME=VALUE,NAME=VALUE`.
//!
//! Names come from other people's data and may hold anything, a comma or an equals sign too. So a text is read with the
//! names that are known, and a name may stand in quotes as in CSV: `"Q, flow"=1`.

use anyhow::{Result, bail};
use clap::error::ErrorKind;

/// The index of each name and its value, in the order of the text that `option` was given.
pub fn parse(option: &str, text: &str, names: &[String]) -> Result<Vec<(usize, f64)>> {
    let mut reader = Reader {
        names,
        readings: Vec::new(),
        complaint: Complaint::Nothing,
        left: usize::MAX,
    };
    reader.items(text, &mut Vec::new());
    if let [reading] = &mut reader.readings[..] {
        return Ok(std::mem::take(reading));
    }
    if !reader.readings.is_empty() {
        bail!(
            "{option}: `{text}` can be read in several ways: put the names into quotes, as in {}=1; the parameters \
             are {}",
            quoted(&names[reader.readings[0][0].0]),
            listed(names)
        );
    }
    match reader.complaint {
        Complaint::Unknown(name) => bail!(
            "{option}: there is no parameter `{name}`: the parameters are {}",
            listed(names)
        ),
        Complaint::NoNumber(name, value) => usage(&format!(
            "{option}: the value of `{name}` is \"{value}\", which is not a finite number"
        )),
        Complaint::NoValue(item) => usage(&format!(
            "{option}: \"{item}\" in `{text}`: expected NAME=VALUE; the parameters are {}",
            listed(names)
        )),
        Complaint::Nothing => usage(&format!("{option}: expected NAME=VALUE")),
    }
}

/// Names in a row, in quotes where commas or equals signs would be misread.
pub fn listed(names: &[String]) -> String {
    let plain = |name: &String| !name.contains([',', '=', '"']) && name.trim() == name;
    let word = |name: &String| if plain(name) { name.clone() } else { quoted(name) };
    names.iter().map(word).collect::<Vec<_>>().join(", ")
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// A mistake in the command line itself.
fn usage<T>(message: &str) -> Result<T> {
    Err(clap::Error::raw(ErrorKind::ValueValidation, format!("{message}\n")).into())
}

/// Reads a text in all the ways that the names allow.
struct Reader<'a> {
    names: &'a [String],
    readings: Vec<Vec<(usize, f64)>>,
    /// The fault farthest along the text, and the length of the text after it.
    complaint: Complaint<'a>,
    left: usize,
}

enum Complaint<'a> {
    Nothing,
    Unknown(&'a str),
    NoNumber(&'a str, &'a str),
    NoValue(&'a str),
}

impl<'a> Reader<'a> {
    /// Reads what follows the items `before`.
    fn items(&mut self, text: &'a str, before: &mut Vec<(usize, f64)>) {
        let text = text.trim_start();
        let names = self.names;
        let mut known = false;
        for (index, name) in names.iter().enumerate() {
            let plain = text.strip_prefix(name.trim());
            for rest in [plain, text.strip_prefix(&quoted(name))].into_iter().flatten() {
                let Some(rest) = rest.trim_start().strip_prefix('=') else {
                    continue;
                };
                known = true;
                let (value, next) = rest.split_once(',').map_or((rest, None), |(v, next)| (v, Some(next)));
                let value = value.trim();
                let Some(number) = value.parse().ok().filter(|number: &f64| number.is_finite()) else {
                    self.complain(rest, Complaint::NoNumber(name, value));
                    continue;
                };
                before.push((index, number));
                match next {
                    Some(next) => self.items(next, before),
                    None if self.readings.contains(before) => {}
                    None => self.readings.push(before.clone()),
                }
                before.pop();
            }
        }
        if !known {
            let item = text.split(',').next().unwrap_or_default().trim();
            let complaint = match text.split_once('=') {
                Some((name, _)) => Complaint::Unknown(name.trim()),
                None => Complaint::NoValue(item),
            };
            self.complain(text, complaint);
        }
    }

    fn complain(&mut self, rest: &'a str, complaint: Complaint<'a>) {
        if rest.len() < self.left {
            self.left = rest.len();
            self.complaint = complaint;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn owned(names: &[&str]) -> Vec<String> {
        names.iter().map(ToString::to_string).collect()
    }

    fn read(text: &str, names: &[&str]) -> Vec<(usize, f64)> {
        parse("--name", text, &owned(names)).unwrap()
    }

    fn refused(text: &str, names: &[&str]) -> String {
        parse("--name", text, &owned(names)).unwrap_err().to_string()
    }

    #[test]
    fn names_that_hold_anything_are_found() {
        let names = ["Q, flow", "size"];
        let expected = [(0, 0.37), (1, 0.66)];
        assert_eq!(read("Q, flow=0.37,size=0.66", &names), expected);
        assert_eq!(read("  Q, flow = 0.37 , size = 6.6e-1", &names), expected);
        assert_eq!(read("\"Q, flow\"=0.37,\"size\"=0.66", &names), expected);
        assert_eq!(read("size=-1", &names), [(1, -1.0)]);
        // The longer name is meant where the shorter one gives no sense.
        assert_eq!(read("a=b=1,a=2", &["a", "a=b"]), [(1, 1.0), (0, 2.0)]);
        assert_eq!(read("a,b=1", &["b", "a", "a,b"]), [(2, 1.0)]);
        assert_eq!(read("Größe α=1", &["Größe α"]), [(0, 1.0)]);
        assert_eq!(read("5\" pipe=1", &["5\" pipe"]), [(0, 1.0)]);
        assert_eq!(read("\"5\"\" pipe\"=1", &["5\" pipe"]), [(0, 1.0)]);
    }

    #[test]
    fn what_can_be_read_in_two_ways_is_refused_and_quotes_tell() {
        let names = ["a", "b", "a=1,b"];
        let error = refused("a=1,b=2", &names);
        assert!(error.contains("several ways") && error.contains("\"a=1,b\""), "{error}");
        assert_eq!(read("\"a\"=1,b=2", &names), [(0, 1.0), (1, 2.0)]);
        assert_eq!(read("\"a=1,b\"=2", &names), [(2, 2.0)]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let names = ["al", "Q, flow"];
        for (text, words) in [
            ("al=1,re=1", &["no parameter `re`", "al, \"Q, flow\""][..]),
            ("Q, flux=1", &["no parameter `Q, flux`"]),
            (
                "al=1,Q, flow=much",
                &["`Q, flow`", "\"much\", which is not a finite number"],
            ),
            ("al=NaN", &["`al`", "\"NaN\", which is not a finite number"]),
            ("al=inf,Q, flow=1", &["`al`", "inf"]),
            ("al=", &["`al`", "\"\""]),
            ("al", &["NAME=VALUE", "al, \"Q, flow\""]),
            ("al=1,", &["NAME=VALUE"]),
            ("", &["NAME=VALUE"]),
        ] {
            let error = refused(text, &names);
            assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
        }
    }

    proptest! {
        #[test]
        fn quoted_names_are_read_back(
            names in prop::collection::hash_set("[a-b=,\" é]{1,5}", 1..4),
            values in prop::collection::vec(-1e3..1e3f64, 3),
        ) {
            let names: Vec<String> = names.into_iter().collect();
            let expected: Vec<(usize, f64)> = values.into_iter().take(names.len()).enumerate().collect();
            let items: Vec<String> = expected.iter().map(|(i, v)| format!("{}={v}", quoted(&names[*i]))).collect();
            // A name may look like another one in quotes: then it is ambiguous, and never the wrong one.
            match parse("--name", &items.join(","), &names) {
                Ok(found) => prop_assert_eq!(found, expected),
                Err(error) => prop_assert!(error.to_string().contains("several ways"), "{}", error),
            }
        }
    }
}
