//! Layers of an OpenEXR file, and the channels of each that are light.
//!
//! Channels are named `R`, or `layer.R` with any dots in the layer's name, and a file may have several parts with names
//! of their own. Light is R, G, B; or luminance Y, with chroma RY and BY or without. Channels Y beside X or Z are
//! positions or normals.

use crate::SceneError;
use exr::meta::header::Header;

/// Names of layers that a note lists at most.
const MOST_LISTED: usize = 8;

/// How three channels or one make a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Red, green, blue.
    Rgb,
    /// Luminance, and chroma of red and blue.
    LuminanceChroma,
    /// Luminance.
    Luminance,
}

/// A layer of light.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layer {
    /// Place of the part in the file.
    pub(super) part: usize,
    pub(super) kind: Kind,
    /// Places of the channels in the part, one per colour; of luminance alone the same three times.
    pub(super) channels: [usize; 3],
    part_name: String,
    /// Names of its channels before the last dot.
    prefix: String,
}

impl Layer {
    fn name(&self) -> String {
        match (self.part_name.as_str(), self.prefix.as_str()) {
            (part, "") => part.to_owned(),
            ("", prefix) => prefix.to_owned(),
            (part, prefix) => format!("{part}.{prefix}"),
        }
    }

    fn is_called(&self, name: &str) -> bool {
        !name.is_empty() && (self.name() == name || self.prefix == name)
    }
}

/// The layer called `wanted`, or the one that has no name within its part: R, G, B before luminance, the first part's
/// before others'. With it, what the user should know of the others.
pub(super) fn choose(headers: &[Header], wanted: Option<&str>) -> Result<(Layer, Vec<String>), SceneError> {
    let layers: Vec<Layer> = headers.iter().enumerate().flat_map(|(part, header)| layers_of(part, header)).collect();
    if let Some(wanted) = wanted {
        let by_name = |exact: bool| {
            let fits = |layer: &&Layer| if exact { layer.name() == wanted } else { layer.is_called(wanted) };
            layers.iter().filter(fits).min_by_key(|layer| layer.kind)
        };
        return by_name(true).or_else(|| by_name(false)).cloned().map(|layer| (layer, Vec::new())).ok_or_else(|| {
            SceneError::new(format!("no layer of light is called `{wanted}`; its channels: {}", listed(headers)))
                .with_remedy(advice(&layers))
        });
    }
    let unnamed = layers.iter().filter(|layer| layer.prefix.is_empty()).min_by_key(|layer| layer.kind);
    let Some(chosen) = unnamed else {
        let problem = "no channels R, G and B (or luminance Y) stand outside of named layers";
        return Err(
            SceneError::new(format!("{problem}; its channels: {}", listed(headers))).with_remedy(advice(&layers))
        );
    };
    let others: Vec<String> = layers
        .iter()
        .filter(|layer| *layer != chosen && layer.kind != Kind::Luminance)
        .map(|layer| format!("`{}`", layer.name()))
        .collect();
    let note = || {
        let more = if others.len() > MOST_LISTED { ", .." } else { "" };
        let listed = others[..others.len().min(MOST_LISTED)].join(", ");
        let taken = if chosen.name().is_empty() { "without a name".into() } else { format!("`{}`", chosen.name()) };
        format!("of its layers of light the one {taken} is taken; others: {listed}{more}")
    };
    Ok((chosen.clone(), (!others.is_empty()).then(note).into_iter().collect()))
}

/// Advice where no layer was chosen.
fn advice(layers: &[Layer]) -> String {
    match layers.iter().map(Layer::name).find(|name| !name.is_empty()) {
        Some(name) => {
            format!("name one: `--env-layer {name}`, or `layer = \"{name}\"` in the environment of a scene file")
        }
        None if layers.is_empty() => "save it with the channels R, G and B".to_owned(),
        None => "leave the layer out".to_owned(),
    }
}

/// The layers of light in one part.
fn layers_of(part: usize, header: &Header) -> Vec<Layer> {
    let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let parted = |name: &str| match name.rsplit_once('.') {
        Some((prefix, last)) => (prefix.to_owned(), last.to_owned()),
        None => (String::new(), name.to_owned()),
    };
    let parted: Vec<(String, String)> = names.iter().map(|name| parted(name)).collect();
    let mut prefixes: Vec<&String> = Vec::new();
    for (prefix, _) in &parted {
        if !prefixes.contains(&prefix) {
            prefixes.push(prefix);
        }
    }
    let part_name = header.own_attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
    let layer = |prefix: &&String| {
        let find = |wanted: &str| {
            let of_case = |exact: bool| {
                parted.iter().position(|(p, name)| {
                    p == *prefix && if exact { name == wanted } else { name.eq_ignore_ascii_case(wanted) }
                })
            };
            of_case(true).or_else(|| of_case(false))
        };
        let (kind, channels) = if let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) {
            (Kind::Rgb, [r, g, b])
        } else {
            let y = find("Y")?;
            match (find("RY"), find("BY")) {
                (Some(ry), Some(by)) => (Kind::LuminanceChroma, [y, ry, by]),
                (None, None) if find("X").is_none() && find("Z").is_none() => (Kind::Luminance, [y; 3]),
                _ => return None,
            }
        };
        Some(Layer { part, kind, channels, part_name: part_name.clone(), prefix: (*prefix).clone() })
    };
    prefixes.iter().filter_map(layer).collect()
}

/// All channels there are, by part.
fn listed(headers: &[Header]) -> String {
    let of_part = |header: &Header| {
        let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        match &header.own_attributes.layer_name {
            Some(part) if headers.len() > 1 => format!("{} in part `{part}`", names.join(", ")),
            _ => names.join(", "),
        }
    };
    headers.iter().map(of_part).collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::meta::attribute::{ChannelDescription, SampleType, Text};

    /// Parts of some name with channels.
    fn parts(parts: &[(&str, &[&str])]) -> Vec<Header> {
        let part = |&(name, channels): &(&str, &[&str])| {
            let channel = |name: &&str| ChannelDescription::new(Text::from(*name), SampleType::F32, false);
            let mut names = channels.to_vec();
            names.sort_unstable();
            Header::new(Text::from(name), (4, 2), names.iter().map(channel).collect())
        };
        parts.iter().map(part).collect()
    }

    fn chosen(headers: &[Header], wanted: Option<&str>) -> (usize, Kind, [usize; 3], usize) {
        let (layer, notes) = choose(headers, wanted).unwrap();
        (layer.part, layer.kind, layer.channels, notes.len())
    }

    #[test]
    fn light_is_told_from_what_is_none() {
        assert_eq!(chosen(&parts(&[("", &["R", "G", "B", "A", "Z"])]), None), (0, Kind::Rgb, [3, 2, 1], 0));
        assert_eq!(chosen(&parts(&[("", &["r", "g", "b"])]), None), (0, Kind::Rgb, [2, 1, 0], 0));
        assert_eq!(chosen(&parts(&[("", &["Y", "A"])]), None), (0, Kind::Luminance, [1; 3], 0));
        assert_eq!(chosen(&parts(&[("", &["Y", "RY", "BY"])]), None), (0, Kind::LuminanceChroma, [2, 1, 0], 0));
        let normals = ("normal", &["X", "Y", "Z"][..]);
        assert_eq!(chosen(&parts(&[normals, ("beauty", &["R", "G", "B"])]), None), (1, Kind::Rgb, [2, 1, 0], 0));
        for none in [&["X", "Y", "Z"][..], &["Y", "RY"], &["X", "Y"], &["Y", "Z"], &["R", "G"], &["N.X", "N.Y", "N.Z"]]
        {
            let error = choose(&parts(&[("", none)]), None).unwrap_err().to_string();
            assert!(error.contains(none[0]) && error.contains("save it with"), "{error}");
        }
    }

    #[test]
    fn layers_by_name() {
        let rgb = |prefix: &str| ["R", "G", "B"].map(|c| format!("{prefix}.{c}"));
        let (a, b) = (rgb("rgba"), rgb("view.left"));
        let all: Vec<&str> = a.iter().chain(&b).map(String::as_str).collect();
        let named = parts(&[("", &all)]);
        let error = choose(&named, None).unwrap_err().to_string();
        for word in ["rgba.R", "view.left.B", "--env-layer rgba", "layer = \"rgba\""] {
            assert!(error.contains(word), "{error}");
        }
        assert_eq!(chosen(&named, Some("rgba")).2, [2, 1, 0]);
        assert_eq!(chosen(&named, Some("view.left")).2, [5, 4, 3]);
        let error = choose(&named, Some("depth")).unwrap_err().to_string();
        assert!(error.contains("`depth`") && error.contains("rgba.R"), "{error}");
        // One without a name comes first, and the others are told.
        let both: Vec<&str> = ["R", "G", "B"].into_iter().chain(all).collect();
        let (layer, notes) = choose(&parts(&[("", &both)]), None).unwrap();
        assert_eq!((layer.prefix.as_str(), layer.channels), ("", [2, 1, 0]));
        assert!(notes[0].contains("without a name") && notes[0].contains("`rgba`"), "{notes:?}");
        assert!(choose(&parts(&[("", &["R", "G", "B"])]), Some("x")).unwrap_err().to_string().contains("leave"));
    }

    #[test]
    fn parts_by_name() {
        let rgb: &[&str] = &["R", "G", "B"];
        let two = parts(&[("depth", &["Y", "A"]), ("left", rgb), ("right", rgb)]);
        let (layer, notes) = choose(&two, None).unwrap();
        assert!(layer.part == 1 && notes[0].contains("`left`") && notes[0].contains("`right`"), "{notes:?}");
        assert_eq!(chosen(&two, Some("right")), (2, Kind::Rgb, [2, 1, 0], 0));
        assert_eq!(chosen(&two, Some("depth")).1, Kind::Luminance);
        let within = parts(&[("main", &["spec.R", "spec.G", "spec.B"])]);
        assert_eq!(chosen(&within, Some("spec")).0, chosen(&within, Some("main.spec")).0);
    }
}
