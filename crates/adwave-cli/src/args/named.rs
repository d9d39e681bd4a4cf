//! Enums of the library under the names that they have on the command line.

/// Defines an enum of arguments for one of the library, both ways between the two, and its default as the library has it.
macro_rules! named {
    ($(#[$about:meta])* $name:ident for $library:ident { $($(#[$help:meta])* $variant:ident = $theirs:ident,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
        pub(crate) enum $name {
            $($(#[$help])* $variant,)*
        }

        impl From<$name> for $library {
            fn from(argument: $name) -> Self {
                match argument {
                    $($name::$variant => Self::$theirs,)*
                }
            }
        }

        impl From<$library> for $name {
            fn from(value: $library) -> Self {
                match value {
                    $($library::$theirs => Self::$variant,)*
                }
            }
        }

        impl Default for $name {
            fn default() -> Self {
                $library::default().into()
            }
        }
    };
}

pub(crate) use named;
