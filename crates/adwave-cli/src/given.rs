//! Options that the user gave: the rule for those that apply to nothing, and checks of the files that a run writes.

use crate::error::CliError;
use clap::ArgMatches;
use clap::parser::ValueSource;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Options that name a file or folder for a result.
const OUTPUTS: [&str; 7] =
    ["--output", "--moved", "--picture", "--save-recipe", "--markdown", "--write-base", "--curve"];

/// Commands whose result is a shape that `-o -` writes to the standard output.
const PIPED: [&str; 5] = ["filter", "denoise", "simplify", "convert", "sample"];

/// Options of one command line.
#[derive(Debug, Default)]
pub(crate) struct GivenOptions {
    command: String,
    /// Long names of the options that were typed, with their dashes.
    options: BTreeSet<String>,
    /// Options of lists that were typed more than once.
    repeated: Vec<String>,
    /// Files and folders that results go to, by the option that names them.
    outputs: Vec<NamedOutput>,
}

/// A file or folder for a result.
#[derive(Debug)]
struct NamedOutput {
    option: String,
    path: PathBuf,
}

impl GivenOptions {
    /// The options that were typed, of a command line that `definition` parsed.
    pub(crate) fn new(matches: &ArgMatches, definition: &clap::Command) -> Self {
        let Some((name, matches)) = matches.subcommand() else { return Self::default() };
        let mut given = Self { command: name.to_owned(), ..Self::default() };
        let arguments = definition.find_subcommand(name).into_iter().flat_map(clap::Command::get_arguments);
        for argument in arguments.filter(|argument| !argument.is_global_set()) {
            let id = argument.get_id().as_str();
            let Some(long) = argument.get_long() else { continue };
            if matches.value_source(id) != Some(ValueSource::CommandLine) {
                continue;
            }
            let option = format!("--{long}");
            let n_times = matches.get_raw_occurrences(id).map_or(0, Iterator::count);
            if argument.get_value_delimiter().is_some() && n_times > 1 {
                given.repeated.push(option.clone());
            }
            if is_output(name, &option) {
                let paths = matches.get_raw(id).into_iter().flatten().map(PathBuf::from);
                given.outputs.extend(paths.map(|path| NamedOutput { option: option.clone(), path }));
            }
            given.options.insert(option);
        }
        given
    }

    /// Name of the subcommand.
    pub(crate) fn command(&self) -> &str {
        &self.command
    }

    /// Returns true if the user typed the option, such as `--rings`.
    pub(crate) fn has(&self, option: &str) -> bool {
        self.options.contains(option)
    }

    /// Returns true if `-o -` sends the result to the standard output.
    pub(crate) fn is_piped(&self) -> bool {
        self.outputs.iter().any(|output| output.option == "--output" && output.path == Path::new("-"))
    }

    /// Returns true if the user typed no options but these.
    pub(crate) fn are_among(&self, options: &[&str]) -> bool {
        self.options.iter().all(|option| options.contains(&option.as_str()))
    }

    /// Refuses the first of `options` that was given although it applies to nothing. `applies` follows the name of the
    /// option and states when it applies, such as `applies to meshes, and a.ply is a cloud`.
    pub(crate) fn refuse(&self, options: &[&str], applies: &str) -> Result<(), CliError> {
        match options.iter().find(|option| self.has(option)) {
            Some(option) => Err(CliError::Input(format!("{option} {applies}; leave it out"))),
            None => Ok(()),
        }
    }

    /// Refuses lists that were given twice, two results with one name, and a standard output that cannot hold the
    /// result.
    pub(crate) fn check(&self) -> Result<(), CliError> {
        if let Some(option) = self.repeated.first() {
            return Err(CliError::Input(format!(
                "{option} must be given once, with all of its values in one list, such as {option} 1,2"
            )));
        }
        for (k, output) in self.outputs.iter().enumerate() {
            let is_for_shape = output.option == "--output" && PIPED.contains(&self.command.as_str());
            if output.path == Path::new("-") && !is_for_shape {
                return Err(CliError::Input(format!(
                    "{} must name a file or folder, got -; only {} write to the standard output",
                    short_name(&output.option),
                    PIPED.join(", ")
                )));
            }
            let same = |other: &&NamedOutput| is_same_place(&other.path, &output.path);
            if let Some(other) = self.outputs[..k].iter().find(same) {
                let names = [other, output].map(|output| short_name(&output.option));
                return Err(CliError::Input(format!(
                    "{} and {} must name different files, got {} for both",
                    names[0],
                    names[1],
                    output.path.display()
                )));
            }
        }
        Ok(())
    }
}

/// True if an option names a file or folder for a result. `--features` is a result of `tiles` and an input of `render`.
fn is_output(command: &str, option: &str) -> bool {
    OUTPUTS.contains(&option) || (command == "tiles" && option == "--features")
}

/// An option as people type it.
fn short_name(option: &str) -> &str {
    if option == "--output" { "-o" } else { option }
}

/// True if two paths name one file, which need not exist.
fn is_same_place(a: &Path, b: &Path) -> bool {
    let resolve = |path: &Path| {
        path.canonicalize().ok().or_else(|| {
            let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
            Some(folder.canonicalize().ok()?.join(path.file_name()?))
        })
    };
    a == b || matches!((resolve(a), resolve(b)), (Some(a), Some(b)) if a == b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(line: &str) -> GivenOptions {
        let definition = crate::cli::command();
        let matches = definition.clone().try_get_matches_from(line.split_whitespace()).unwrap();
        GivenOptions::new(&matches, &definition)
    }

    #[test]
    fn defaults_are_not_given() {
        let options = given("adwave info a.ply --rings 1 --json");
        assert!(options.has("--rings") && !options.has("--neighbors") && !options.has("--json"));
        let refused = options.refuse(&["--neighbors", "--rings"], "applies to meshes").unwrap_err();
        assert_eq!(refused.to_string(), "--rings applies to meshes; leave it out");
    }

    #[test]
    fn results_have_names_of_their_own() {
        assert!(given("adwave match a.ply b.ply -o p.csv --moved q.ply").check().is_ok());
        let refused = given("adwave match a.ply b.ply -o p.csv --moved ./p.csv").check().unwrap_err();
        assert_eq!(refused.to_string(), "-o and --moved must name different files, got ./p.csv for both");
        assert!(given("adwave tiles a.las -o q.ply --features q.ply").check().is_err());
        assert!(given("adwave render a.ply -o q.png --features q.csv").check().is_ok());
    }

    #[test]
    fn only_shapes_go_to_the_standard_output() {
        let piped = given("adwave filter a.ply -o - --gains 0");
        assert!(piped.check().is_ok() && piped.is_piped());
        assert!(given("adwave demo -o -").check().is_err());
        assert!(given("adwave filter a.ply -o b.ply --gains 0 --save-recipe -").check().is_err());
    }

    #[test]
    fn a_list_is_given_once() {
        assert!(given("adwave filter a.ply -o b.ply --gains 1 --gains 2").check().is_err());
        assert!(given("adwave info a.ply --only x=1 --only y=2").check().is_ok());
    }
}
