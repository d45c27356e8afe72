//! Error against time, log-log: which method to choose at which price; and both over the frames of a scene.
//!
//! One colour per strategy, fixed by its place in the list of all; one mark and line per choice of words among its parameters, the
//! same in all plots of some results; numbers among its parameters are written beside the points, which are
//! joined in the order of time. Bars show the median absolute deviation of the time and the error's interval, in
//! results without intervals the truth's noise. The grey staircase is the Pareto front: nothing measured is both faster and more exact. Unresolved errors are drawn
//! hollow, at the value that the truth can just resolve. A plot is as high as its legend needs.

mod chart;
mod embedded;
mod frames;
mod labels;
mod legend;
mod series;
mod spots;
mod stacked;
#[cfg(test)]
mod stored;
mod style;
mod ticks;

use super::{groups::Group, stages::taken_apart};
use crate::{
    file_names,
    image_io::png_bytes,
    results::{Results, Run},
};
use embedded::with_font;
use legend::Legend;
use plotters::{coord::Shift, prelude::*};
use series::{Kinds, Series};
use spots::{Spot, with_spots};
use stacked::Bar;
use style::{SIZE, register_font};

/// Frames of a scene from which on errors and times are drawn over them.
pub const LEAST_FRAMES: usize = 3;

/// A plot, ready to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Path of its files without their ending, relative to the results.
    pub file: String,
    /// Its title.
    pub title: String,
    kind: Kind,
    series: Vec<Series>,
    bars: Vec<Bar>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Times are of so many threads.
    ErrorAgainstTime { threads: usize },
    /// Every series is one variant.
    OverFrames,
    /// A bar for every variant.
    Stacked,
}

impl Plot {
    /// Error against time of all strategies, for every group in which something was both scored and timed; others have none.
    pub fn error_against_time(results: &Results, groups: &[Group]) -> Vec<Option<Self>> {
        let kinds = Kinds::new(results);
        let plot = |group: &Group| {
            let series = kinds.series(group);
            (!series.is_empty()).then(|| Self {
                file: file_names::plot(&group.scene, group.frame, &group.receivers),
                title: format!("{}: error against time", group.place()),
                kind: Kind::ErrorAgainstTime { threads: results.machine.threads },
                series,
                bars: Vec::new(),
            })
        };
        groups.iter().map(plot).collect()
    }

    /// Error and time over frames, for every scene and kind of receivers of [`LEAST_FRAMES`] or more; each with that name.
    pub fn over_frames(results: &Results, groups: &[Group]) -> Vec<(String, Self)> {
        let kinds = Kinds::new(results);
        let mut plots = Vec::new();
        for (place, group) in groups.iter().enumerate() {
            let is_same = |other: &&Group| (&other.scene, &other.receivers) == (&group.scene, &group.receivers);
            let frames: Vec<&Group> = groups.iter().filter(is_same).collect();
            if frames.len() < LEAST_FRAMES || groups[..place].iter().any(|other| is_same(&other)) {
                continue;
            }
            let series = kinds.curves(&frames);
            if series.is_empty() {
                continue;
            }
            let name = format!("{}, {}", group.scene, group.receivers);
            let file = file_names::plot_over_frames(&group.scene, &group.receivers);
            plots.push((
                name,
                Self {
                    file,
                    title: format!("{}: over frames", group.scene),
                    kind: Kind::OverFrames,
                    series,
                    bars: Vec::new(),
                },
            ));
        }
        plots
    }

    /// What stages contribute to the errors of a group, if any error was taken apart.
    pub fn stacked(results: &Results, group: &Group) -> Option<Self> {
        let bar = |run: &Run| {
            let error = run.error.as_ref()?.metrics.rel_rmse?;
            let parts = run.stages.iter().map(|stage| (stage.stage.clone(), stage.share * error)).collect();
            Some(Bar { label: run.label.clone(), parts })
        };
        let bars: Vec<Bar> = taken_apart(results, group).filter_map(bar).collect();
        (!bars.is_empty()).then(|| Self {
            file: file_names::plot_of_stages(&group.scene, group.frame, &group.receivers),
            title: format!("{}: where the error comes from", group.place()),
            kind: Kind::Stacked,
            series: Vec::new(),
            bars,
        })
    }

    /// Width and height in pixels.
    fn size(&self, scale: u32) -> (u32, u32) {
        if self.kind == Kind::Stacked {
            return (SIZE.0 * scale, stacked::height(&self.bars) * scale);
        }
        let legend = Legend::new(&self.series, self.kind != Kind::OverFrames);
        (SIZE.0 * scale, legend.height() * scale)
    }

    /// Draws it; returns its points, for who can point at them.
    fn draw<B: DrawingBackend>(&self, area: &DrawingArea<B, Shift>, scale: u32) -> Result<Vec<Spot>, String> {
        match self.kind {
            Kind::ErrorAgainstTime { threads } => chart::draw(area, scale, &self.title, threads, &self.series),
            Kind::OverFrames => frames::draw(area, scale, &self.title, &self.series),
            Kind::Stacked => stacked::draw(area, scale, &self.title, &self.bars),
        }
    }

    /// The plot as SVG, its font within it; points tell their values to who points at them.
    pub fn svg(&self) -> Result<String, String> {
        with_font(&self.svg_without_font()?, &self.title)
    }

    /// The same without the font, for a page that has several.
    pub fn svg_without_font(&self) -> Result<String, String> {
        register_font();
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, self.size(1)).into_drawing_area();
        let spots = self.draw(&area, 1)?;
        drop(area);
        Ok(with_spots(&svg, &spots))
    }

    /// The plot as a PNG of twice the size, so that it stays sharp on dense screens.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        register_font();
        let (width, height) = self.size(2);
        let mut pixels = vec![0; 3 * (width * height) as usize];
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        self.draw(&area, 2)?;
        drop(area);
        let image = image::RgbImage::from_raw(width, height, pixels).ok_or("the bitmap has a wrong size")?;
        png_bytes(&image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{report::groups::tests::only, results::tests::example};

    #[test]
    fn stages_are_stacked_and_tell_their_contributions() {
        let plot = Plot::stacked(&crate::report::stages::tests::example_apart(), &only()).unwrap();
        let svg = plot.svg().unwrap();
        assert!(svg.contains("<title>fast:bands=4: bands 25 %</title>"), "{svg}");
        assert!(
            svg.contains("<title>fast:bands=4: rest -5.0 %</title>")
                && svg.contains("contribution to the relative RMSE")
        );
        assert!(Plot::stacked(&example(), &only()).is_none());
    }

    #[test]
    fn both_formats_are_drawn_whole() {
        let plots = Plot::error_against_time(&example(), &[only(), Group { frame: 1, ..only() }]);
        assert!(plots.len() == 2 && plots[1].is_none());
        let plot = plots[0].clone().unwrap();
        let (svg, png) = (plot.svg().unwrap(), plot.png().unwrap());
        assert!(
            svg.trim_end().ends_with("</svg>")
                && svg.contains("relative RMSE")
                && svg.contains("@font-face")
                && svg.contains("Pareto front")
        );
        let image = image::load_from_memory(&png).unwrap();
        assert_eq!((image.width(), image.height()), (2 * SIZE.0, 2 * SIZE.1));
    }
}
