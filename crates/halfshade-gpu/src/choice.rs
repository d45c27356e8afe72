//! Which graphics device a user wants.

use std::{convert::Infallible, str::FromStr};

/// A wish, as `--gpu` and `HALFSHADE_GPU` tell it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Choice {
    /// `auto`: hardware before software, discrete before integrated.
    #[default]
    Auto,
    /// `off`: none.
    Off,
    /// A number in the list of devices, from 0.
    Number(usize),
    /// A part of the device's name, whatever the case.
    Name(String),
}

impl FromStr for Choice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        let text = text.trim();
        Ok(match text.to_ascii_lowercase().as_str() {
            "" | "auto" => Self::Auto,
            "off" => Self::Off,
            _ => text.parse().map_or_else(|_| Self::Name(text.to_owned()), Self::Number),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_names_are_told_apart() {
        let read = |text: &str| text.parse::<Choice>().unwrap();
        assert_eq!((read("auto"), read(""), read("OFF")), (Choice::Auto, Choice::Auto, Choice::Off));
        assert_eq!((read("1"), read("llvmpipe")), (Choice::Number(1), Choice::Name("llvmpipe".into())));
    }
}
