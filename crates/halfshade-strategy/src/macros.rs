//! Parameters declared once, as types: a strategy's settings are a struct, its choices are enums, and both tell their
//! names, summaries and ranges.
//!
//! ```
//! use halfshade_strategy::{choice, settings};
//!
//! choice! {
//!     /// Order of the blockers.
//!     pub enum Order {
//!         /// by the distance of their centres
//!         Center = "center",
//!         /// by power distance
//!         Power = "power",
//!     }
//! }
//!
//! settings! {
//!     /// Everything that can be set.
//!     pub struct Settings {
//!         /// which of two blockers is nearer
//!         "order" => order: Order = Order::Center;
//!         /// bands of visibility
//!         "bands" => bands: usize = 4, in 1..=8, levels ["2", "4", "8"];
//!     }
//! }
//!
//! assert_eq!(Settings::parameters()[1].levels, ["2", "4", "8"]);
//! assert_eq!(Settings::parameters()[0].kind.range(), "center | power");
//! assert_eq!(Settings::default().bands, 4);
//! ```

/// An enum of the words that a parameter may be set to, with the docs of each as its one-line summary. `enum A for B` also
/// turns A into B, an enum elsewhere that has the same variants.
#[macro_export]
macro_rules! choice {
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $name:ident for $other:ty {
            $( $(#[doc = $summary:literal])+ $variant:ident = $word:literal, )+
        }
    ) => {
        $crate::choice! {
            $(#[$attribute])*
            $visibility enum $name {
                $( $(#[doc = $summary])+ $variant = $word, )+
            }
        }

        impl From<$name> for $other {
            fn from(chosen: $name) -> Self {
                match chosen {
                    $( $name::$variant => Self::$variant, )+
                }
            }
        }
    };
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $name:ident {
            $( $(#[doc = $summary:literal])+ $variant:ident = $word:literal, )+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $visibility enum $name {
            $( $(#[doc = $summary])+ $variant, )+
        }

        impl $crate::settings::Choice for $name {
            const WORDS: &'static [$crate::Word] = &[
                $( $crate::Word { name: $word, summary: concat!($($summary),+).trim_ascii() }, )+
            ];
            const ALL: &'static [Self] = &[$( Self::$variant ),+];
        }
    };
}

/// A struct of everything that can be set: per field its key, type, default, range, and the levels at which it trades error for
/// time, with its docs as the one-line summary.
#[macro_export]
macro_rules! settings {
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $name:ident {
            $(
                $(#[doc = $summary:literal])+
                $key:literal => $field:ident: $kind:ty = $default:expr $(, in $range:expr)? $(, levels $levels:expr)?;
            )*
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, PartialEq)]
        $visibility struct $name {
            $( $(#[doc = $summary])+ $visibility $field: $kind, )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $field: $default, )* }
            }
        }

        impl $name {
            /// The parameters, in the order in which they are declared.
            $visibility fn parameters() -> Vec<$crate::Parameter> {
                vec![ $( $crate::Parameter {
                    name: $key,
                    summary: concat!($($summary),+).trim_ascii(),
                    kind: <$kind as $crate::settings::Setting>::kind(
                        $default,
                        None $(.or(Some($range)))?,
                    ),
                    // The first of what is given and nothing.
                    levels: [$( &$levels as &'static [&'static str], )? &[]][0],
                }, )* ]
            }

            /// The values that are set.
            $visibility fn read(params: &$crate::Params) -> Self {
                Self { $( $field: params.get($key), )* }
            }
        }
    };
}
