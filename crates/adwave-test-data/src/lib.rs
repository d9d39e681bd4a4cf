//! Tests on real files, which lie in `../shared/data` beside the repository or in the folder that `ADWAVE_DATA`
//! names.
//!
//! Rust's test harness cannot skip a test at run time. Therefore the folder is located when the tests are built; if
//! it is missing, they are marked `#[ignore]`, so that the summary counts them as ignored. Once the folder is there,
//! set `ADWAVE_DATA`, or touch this crate's `build.rs`: a missing folder is not watched.

use proc_macro::{Literal, TokenStream, TokenTree};

/// Folder of test files.
const FOLDER: &str = env!("ADWAVE_TEST_DATA");

/// True if the folder existed at build time.
const IS_THERE: bool = option_env!("ADWAVE_TEST_DATA_MISSING").is_none();

/// Marks a test that reads files of [`folder!`] as `#[test]`; the test is ignored, with the reason, if the folder is
/// missing.
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

/// Absolute path of the folder of test files as a string literal, also if the folder is missing.
#[proc_macro]
pub fn folder(_: TokenStream) -> TokenStream {
    TokenTree::from(Literal::string(FOLDER)).into()
}
