//! Limits for the countable rules of style: first words of doc comments, names, lengths, circular imports.

use std::path::Path;
use xtask::style::check;

/// Largest share of doc comments that begin with What, Who, Which and the like; other code bases have 0.7 to 4 %.
const RIDDLE_SHARE: f64 = 0.03;
/// Largest number of tuple parameters.
const TUPLE_PARAMETERS: usize = 1;
/// Largest number of functions with more than six arguments.
const MANY_ARGUMENTS: usize = 5;
/// Largest number of functions over 80 lines.
const LONG_FUNCTIONS: usize = 8;

#[test]
fn the_tree_keeps_the_countable_rules_of_style() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let violations = check(root, ".").unwrap();
    assert!(violations.n_doc_comments > 5000, "{} doc comments were looked at", violations.n_doc_comments);
    let share = violations.riddle_share();
    assert!(
        share < RIDDLE_SHARE,
        "{:.1} % of doc comments begin with a riddle: `cargo xtask style`",
        100.0 * share
    );
    let most = [
        (&violations.long_markdown, 0, "lines of Markdown over 120 characters"),
        (&violations.function_names, 0, "functions named by a preposition or participle"),
        (&violations.type_names, 0, "type names defined in more than two modules"),
        (&violations.tuple_parameters, TUPLE_PARAMETERS, "tuple parameters"),
        (&violations.many_arguments, MANY_ARGUMENTS, "functions with more than six arguments"),
        (&violations.long_functions, LONG_FUNCTIONS, "functions over 80 lines"),
        (&violations.import_cycles, 0, "import cycles larger than a folder"),
    ];
    for (list, bound, rule) in most {
        assert!(list.len() <= bound, "{} {rule}, at most {bound}:\n{}", list.len(), list.join("\n"));
    }
}

#[test]
fn violations_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let git = |arguments: &[&str]| {
        std::process::Command::new("git").args(arguments).current_dir(folder.path()).output().unwrap()
    };
    git(&["init", "-q"]);
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    write("c/src/lib.rs", "//! A crate.\nmod a;\nmod b;\n");
    write(
        "c/src/a/mod.rs",
        "//! What is here.\nuse crate::b::F;\n/// Which one.\npub struct T;\nfn told(x: (i32, i32)) {}\n",
    );
    write(
        "c/src/b/mod.rs",
        "//! Functions.\nuse crate::a::T;\nfn of_all(a: i32, b: i32, c: i32, d: i32, e: i32, f: i32, g: i32) {}\n",
    );
    for name in ["x", "y", "z"] {
        write(&format!("c/src/{name}.rs"), "struct Found;\n#[cfg(test)]\nmod tests { fn told() {} }\n");
    }
    write("c/src/long.rs", &format!("fn f() {{\n{}}}\n", "    g();\n".repeat(80)));
    write("read.md", &format!("| {0} |\n{0}\n", "a".repeat(121)));
    let violations = check(folder.path(), ".").unwrap();
    let counts: Vec<usize> = violations.rules().iter().map(|(_, list)| list.len()).collect();
    // The circle takes a line for itself and one for each of its two files.
    assert_eq!(counts, [2, 1, 2, 1, 1, 1, 1, 3], "{violations:#?}");
    assert_eq!(violations.n_doc_comments, 4);
}
