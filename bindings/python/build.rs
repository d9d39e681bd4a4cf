//! Linker arguments that leave the interpreter's symbols undefined, and that merge functions with the same code.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
    // The linker that comes with the compiler for this target supports this option.
    let target = std::env::var("TARGET").unwrap_or_default();
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if is_release && target == "x86_64-unknown-linux-gnu" {
        println!("cargo:rustc-cdylib-link-arg=-Wl,--icf=all");
    }
}
