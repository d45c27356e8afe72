//! Types that a parameter may have: numbers, and choices between words.

use crate::{ParameterKind, Value, Word};
use std::ops::RangeInclusive;

/// A type that a parameter may have.
pub trait Setting: Sized {
    /// Type, default and range as a parameter tells them; without a `range`, all there is.
    fn kind(default: Self, range: Option<RangeInclusive<Self>>) -> ParameterKind;

    /// The value; `None` if it is of another type.
    fn read(value: &Value) -> Option<Self>;
}

/// One of a few words; the macro `choice!` implements it.
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
