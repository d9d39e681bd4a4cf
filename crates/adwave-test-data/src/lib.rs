//! Tests on real files, which lie in `../shared/data` beside the repository or in the folder that `ADWAVE_DATA` names.
//!
//! Rust's test harness cannot skip a test while it runs. So the folder is looked for when the tests are built, and where it
//! is missing they are marked `#[ignore]`: the summary counts them, and a run without the files does not look like one with
//! them. Once the folder is there, set `ADWAVE_DATA`, or touch this crate's `build.rs`: a missing folder is not watched.

use proc_macro::{Literal, TokenStream, TokenTree};

/// The folder of test files.
const FOLDER: &str = env!("ADWAVE_TEST_DATA");

/// Whether it was there when this was built.
const IS_THERE: bool = option_env!("ADWAVE_TEST_DATA_MISSING").is_none();

/// `#[test]` for a test that reads files of [`folder!`]: ignored, with the reason, where the folder is missing.
///
/// ```
/// #[adwave_test_data::data_test]
/// fn the_list_of_files_is_there() {
///     assert!(std::path::Path::new(adwave_test_data::folder!()).join("MANIFEST.md").is_file());
/// }
/// ```
#[proc_macro_attribute]
pub fn data_test(_: TokenStream, function: TokenStream) -> TokenStream {
    let ignore =
        if IS_THERE { String::new() } else { format!("#[ignore = {:?}]", format!("needs {FOLDER}")) };
    let mut test: TokenStream = format!("#[test] {ignore}").parse().expect("two attributes");
    test.extend(function);
    test
}

/// The absolute path of the folder of test files, a string literal, whether it is there or not.
#[proc_macro]
pub fn folder(_: TokenStream) -> TokenStream {
    TokenTree::from(Literal::string(FOLDER)).into()
}
