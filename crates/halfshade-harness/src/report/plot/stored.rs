//! Every stored plot, measured as it would be seen: no text on another or on a mark, no two series alike, nothing left out.

use super::{
    super::{Plot, groups::Group},
    Kind,
    labels::Rect,
    series::Point,
    style::{FAMILY, MARKS, register_font},
};
use crate::Results;
use plotters::prelude::*;
use std::{fs, path::Path};

/// Text of a plot, its place, and the size of its letters as the library counts it.
struct Shown {
    text: String,
    rect: Rect,
    size: f64,
}

/// Value of an attribute of an element.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let start = element.find(&format!(" {name}=\""))? + name.len() + 3;
    element[start..].split('"').next()
}

fn texts(svg: &str) -> Vec<Shown> {
    let elements = svg.split("<text").skip(1);
    elements
        .map(|element| {
            let number = |name: &str| attribute(element, name).unwrap().parse::<f64>().unwrap();
            let text = element.split('>').nth(1).unwrap().split('<').next().unwrap().trim().replace("&amp;", "&");
            // The library writes letters smaller than it counts them.
            let size = 1.24 * number("font-size");
            let (width, height) = (FAMILY, size).into_font().box_size(&text).unwrap();
            let (mut width, mut height) = (f64::from(width), f64::from(height));
            let (x, y) = (number("x"), number("y"));
            let mut left = match attribute(element, "text-anchor").unwrap() {
                "start" => x,
                "middle" => x - 0.5 * width,
                _ => x - width,
            };
            let mut top = match attribute(element, "dy").unwrap() {
                "0.76em" => y,
                "0.5ex" => y - 0.5 * height,
                _ => y - height,
            };
            if attribute(element, "transform").is_some() {
                (width, height) = (height, width);
                (left, top) = (x, y - 0.5 * height);
            }
            let rect = Rect {
                left: left as i32,
                top: top as i32,
                right: (left + width) as i32 - 1,
                bottom: (top + height) as i32 - 1,
            };
            Shown { text, rect, size }
        })
        .collect()
}

fn marks(svg: &str) -> Vec<Rect> {
    let polygons = svg.split("<polygon").skip(1).filter_map(|element| attribute(element, "points"));
    polygons
        .map(|points| {
            let numbers: Vec<i32> = points.split([' ', ',']).filter_map(|number| number.parse().ok()).collect();
            let of = |first: usize| numbers.iter().skip(first).step_by(2).copied();
            Rect {
                left: of(0).min().unwrap(),
                top: of(1).min().unwrap(),
                right: of(0).max().unwrap(),
                bottom: of(1).max().unwrap(),
            }
        })
        .collect()
}

/// Points that have numbers; over frames the last of each curve, for error and, where it was timed, for time.
fn expected_numbers(plot: &Plot) -> usize {
    let told = |point: &Point| usize::from(!point.numbers.is_empty());
    let points = || plot.series.iter().flat_map(|series| &series.points);
    match plot.kind {
        Kind::ErrorAgainstTime { .. } => points().map(told).sum(),
        Kind::OverFrames => {
            let last = plot.series.iter().filter_map(|series| series.points.last());
            last.map(|point| told(point) * if point.frame_secs > 0.0 { 2 } else { 1 }).sum()
        }
        Kind::Stacked => 0,
    }
}

fn check(plot: &Plot, svg: &str, place: &str) {
    let (texts, marks) = (texts(svg), marks(svg));
    for (i, own) in texts.iter().enumerate() {
        let other = texts[..i].iter().find(|other| other.rect.overlaps(&own.rect));
        assert!(other.is_none(), "{place}: `{}` lies on `{}`", own.text, other.unwrap().text);
        assert!(!marks.iter().any(|mark| mark.overlaps(&own.rect)), "{place}: `{}` lies on a mark", own.text);
    }
    let numbers = texts.iter().filter(|shown| (shown.size - 12.0).abs() < 0.1).count();
    assert_eq!(numbers, expected_numbers(plot), "{place}: points without their numbers");
    if !matches!(plot.kind, Kind::ErrorAgainstTime { .. }) {
        return;
    }
    let of_processor: Vec<_> = plot.series.iter().filter(|series| series.name == series.kind).collect();
    for (i, own) in of_processor.iter().enumerate() {
        let alike = of_processor[..i].iter().find(|other| match of_processor.len() <= MARKS {
            true => other.look.mark == own.look.mark,
            false => (other.look.mark, other.look.dash) == (own.look.mark, own.look.dash),
        });
        assert!(alike.is_none(), "{place}: {} looks like {}", own.name, alike.unwrap().name);
    }
    assert!(texts.iter().filter(|it| it.text.ends_with(" %")).count() >= 2, "{place}: an axis without ticks");
}

#[test]
fn stored_plots_can_be_read_and_are_those_of_their_results() {
    register_font();
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results");
    let mut count = 0;
    for entry in fs::read_dir(&results).unwrap() {
        let folder = entry.unwrap().path();
        if !folder.join("plots").is_dir() {
            continue;
        }
        let stored = Results::load(&folder).unwrap();
        let groups = Group::all(&stored);
        let over_frames = Plot::over_frames(&stored, &groups).into_iter().map(|(_, plot)| plot);
        let stacked = groups.iter().filter_map(|group| Plot::stacked(&stored, group));
        for plot in Plot::error_against_time(&stored, &groups).into_iter().flatten().chain(over_frames).chain(stacked) {
            let path = folder.join(&plot.file).with_added_extension("svg");
            let svg = plot.svg().unwrap();
            check(&plot, &svg, &path.display().to_string());
            let kept = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(
                kept == svg,
                "{} is not the plot of its results: run halfshade report on the folder",
                path.display()
            );
            count += 1;
        }
    }
    assert!(count > 50, "{count}");
}
