//! What the linker needs to leave the interpreter's symbols open, and to keep one of several functions with the same code.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
    // Where the linker is the one that comes with the compiler, which knows the word.
    let target = std::env::var("TARGET").unwrap_or_default();
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if is_release && target == "x86_64-unknown-linux-gnu" {
        println!("cargo:rustc-cdylib-link-arg=-Wl,--icf=all");
    }
}
