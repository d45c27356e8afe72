//! Error against time, log-log: which method to choose at which price.
//!
//! One colour per strategy, fixed by its place in the list of all; one mark and line per choice of words among its parameters, the
//! same in all plots of some results; numbers among its parameters are written beside the points, which are
//! joined in the order of time. Bars show the median absolute deviation of the time and the truth's noise in the
//! error. The grey staircase is the Pareto front: nothing measured is both faster and more exact. Unresolved errors are drawn
//! hollow, at the value that the truth can just resolve. A plot is as high as its legend needs.

mod chart;
mod embedded;
mod labels;
mod legend;
mod series;
#[cfg(test)]
mod stored;
mod style;
mod ticks;

use super::groups::Group;
use crate::{file_names, image_io::png_bytes, results::Results};
use chart::draw;
use embedded::with_font;
use legend::Legend;
use plotters::prelude::*;
use series::{Kinds, Series};
use style::{SIZE, register_font};

/// The plot of one frame of one scene, ready to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Path of its files without their ending, relative to the results.
    pub file: String,
    title: String,
    threads: usize,
    series: Vec<Series>,
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
                threads: results.machine.threads,
                series,
            })
        };
        groups.iter().map(plot).collect()
    }

    /// Width and height in pixels.
    fn size(&self, scale: u32) -> (u32, u32) {
        (SIZE.0 * scale, Legend::new(&self.series).height() * scale)
    }

    /// The plot as SVG, its font within it.
    pub fn svg(&self) -> Result<String, String> {
        register_font();
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, self.size(1)).into_drawing_area();
        draw(&area, 1, &self.title, self.threads, &self.series)?;
        drop(area);
        with_font(&svg, &self.title)
    }

    /// The plot as a PNG of twice the size, so that it stays sharp on dense screens.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        register_font();
        let (width, height) = self.size(2);
        let mut pixels = vec![0; 3 * (width * height) as usize];
        {
            let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
            draw(&area, 2, &self.title, self.threads, &self.series)?;
        }
        let image = image::RgbImage::from_raw(width, height, pixels).ok_or("the bitmap has a wrong size")?;
        png_bytes(&image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{report::groups::tests::only, results::tests::example};

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
