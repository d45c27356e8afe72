//! The font within the picture, so that a plot looks alike wherever it is shown and printed.

use super::style::FAMILY;
use allsorts::{
    binary::read::ReadScope,
    error::ParseError,
    font::{Font, MatchingPresentation},
    font_data::FontData,
    subset::{CmapTarget, SubsetProfile, subset},
    tables::FontTableProvider,
    tag,
};
use base64::{Engine, engine::general_purpose::STANDARD};
use std::{borrow::Cow, collections::BTreeSet};

/// A table of no names, which browsers ask for: that of a font takes more than its letters.
const NO_NAMES: [u8; 6] = [0, 0, 0, 0, 0, 6];

/// A font without its names.
struct Nameless<P>(P);

impl<P: FontTableProvider> FontTableProvider for Nameless<P> {
    fn table_data(&self, tag: u32) -> Result<Option<Cow<'_, [u8]>>, ParseError> {
        if tag == tag::NAME { Ok(Some(Cow::Borrowed(&NO_NAMES))) } else { self.0.table_data(tag) }
    }

    fn has_table(&self, tag: u32) -> bool {
        self.0.has_table(tag)
    }

    fn table_tags(&self) -> Option<Vec<u32>> {
        self.0.table_tags()
    }
}

/// `svg` with the glyphs that its text needs, as a style at its beginning; only its `title` is bold.
pub(super) fn with_font(svg: &str, title: &str) -> Result<String, String> {
    let letters_of = |text: &str| text.chars().filter(|letter| !letter.is_control()).collect::<BTreeSet<char>>();
    let face = |font: &[u8], weight: &str, text: &str| -> Result<String, String> {
        let data = STANDARD.encode(reduced(font, &letters_of(text))?);
        Ok(format!("@font-face{{font-family:\"{FAMILY}\";font-weight:{weight};src:url(data:font/ttf;base64,{data})}}"))
    };
    let style = face(dejavu::sans::regular(), "normal", svg)? + &face(dejavu::sans::bold(), "bold", title)?;
    let place = svg.find('>').ok_or("the picture has no beginning")? + 1;
    Ok(format!("{}\n<style>{style}</style>{}", &svg[..place], &svg[place..]))
}

/// A font of those glyphs alone that `letters` need.
fn reduced(font: &[u8], letters: &BTreeSet<char>) -> Result<Vec<u8>, String> {
    let provider = || {
        let file = ReadScope::new(font).read::<FontData<'_>>().map_err(|error| error.to_string())?;
        file.table_provider(0).map_err(|error| error.to_string())
    };
    let mut known = Font::new(provider()?).map_err(|error| error.to_string())?;
    // The first glyph stands for letters that a font lacks.
    let mut glyphs = vec![0];
    for letter in letters {
        let (glyph, _) = known.lookup_glyph_index(*letter, MatchingPresentation::NotRequired, None);
        if !glyphs.contains(&glyph) {
            glyphs.push(glyph);
        }
    }
    subset(&Nameless(provider()?), &glyphs, &SubsetProfile::Minimal, CmapTarget::Unicode)
        .map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_the_letters_of_the_text_and_no_more() {
        let letters: BTreeSet<char> = "0.1 µs, √ 5 %".chars().collect();
        let font = reduced(dejavu::sans::regular(), &letters).unwrap();
        assert!(font.len() < 6_000, "{}", font.len());
        let file = ReadScope::new(&font).read::<FontData<'_>>().unwrap();
        let mut known = Font::new(file.table_provider(0).unwrap()).unwrap();
        let mut has = |letter| known.lookup_glyph_index(letter, MatchingPresentation::NotRequired, None).0 != 0;
        assert!(letters.iter().all(|letter| has(*letter)) && !has('A'));
        let svg = with_font("<svg width=\"1\">\n<text>a</text></svg>\n", "b").unwrap();
        assert!(svg.starts_with("<svg width=\"1\">\n<style>@font-face{") && svg.ends_with("<text>a</text></svg>\n"));
        assert_eq!(svg.matches("@font-face").count(), 2);
    }
}
