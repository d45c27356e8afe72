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
//!         "bands" => bands: usize = 4, in 1..=8;
//!     }
//! }
//!
//! assert_eq!(Settings::parameters()[0].kind.range(), "center | power");
//! assert_eq!(Settings::default().bands, 4);
//! ```

use crate::{ParameterKind, Value, Word};
use std::ops::RangeInclusive;

/// A type that a parameter may have.
pub trait Setting: Sized {
    /// Type, default and range as a parameter tells them; without a `range`, all there is.
    fn kind(default: Self, range: Option<RangeInclusive<Self>>) -> ParameterKind;

    /// The value; `None` if it is of another type.
    fn read(value: &Value) -> Option<Self>;
}

/// One of a few words; [`choice!`](crate::choice) implements it.
pub trait Choice: Copy + PartialEq + 'static {
    /// The words, in the order of [`Self::ALL`].
    const WORDS: &'static [Word];
    /// Every value.
    const ALL: &'static [Self];

    /// The word for this value.
    fn word(self) -> &'static str {
        let place = Self::ALL.iter().position(|value| *value == self);
        place.map_or("", |place| Self::WORDS[place].name)
    }
}

impl<T: Choice> Setting for T {
    fn kind(default: Self, _: Option<RangeInclusive<Self>>) -> ParameterKind {
        ParameterKind::Choice { words: Self::WORDS, default: default.word() }
    }

    fn read(value: &Value) -> Option<Self> {
        let Value::Choice(word) = value else { return None };
        Self::WORDS.iter().position(|known| known.name == *word).map(|place| Self::ALL[place])
    }
}

macro_rules! whole_numbers {
    ($($number:ty),*) => { $(
        impl Setting for $number {
            fn kind(default: Self, range: Option<RangeInclusive<Self>>) -> ParameterKind {
                let range = range.unwrap_or(Self::MIN..=Self::MAX);
                // Ranges are written by strategies: what doesn't fit 64 bits with a sign is no sensible bound.
                let whole = |value: Self| i64::try_from(value).unwrap_or(i64::MAX);
                ParameterKind::Integer { default: whole(default), min: whole(*range.start()), max: whole(*range.end()) }
            }

            fn read(value: &Value) -> Option<Self> {
                let Value::Integer(number) = value else { return None };
                (*number).try_into().ok()
            }
        }
    )* };
}

macro_rules! real_numbers {
    ($($number:ty),*) => { $(
        impl Setting for $number {
            fn kind(default: Self, range: Option<RangeInclusive<Self>>) -> ParameterKind {
                let range = range.unwrap_or(Self::MIN..=Self::MAX);
                // By their digits: 0.2 in single precision is to be told as 0.2.
                let real = |value: Self| value.to_string().parse().unwrap_or(f64::from(value));
                ParameterKind::Float { default: real(default), min: real(*range.start()), max: real(*range.end()) }
            }

            fn read(value: &Value) -> Option<Self> {
                let Value::Float(number) = value else { return None };
                Some(*number as $number)
            }
        }
    )* };
}

whole_numbers!(u32, usize);
real_numbers!(f32, f64);

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

/// A struct of everything that can be set: per field its key, type, default and range, with its docs as the one-line
/// summary.
#[macro_export]
macro_rules! settings {
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $name:ident {
            $(
                $(#[doc = $summary:literal])+
                $key:literal => $field:ident: $kind:ty = $default:expr $(, in $range:expr)?;
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
                }, )* ]
            }

            /// The values that are set.
            $visibility fn read(params: &$crate::Params) -> Self {
                Self { $( $field: params.get($key), )* }
            }
        }
    };
}
