//! Error against time, log-log: which method to choose at which price.
//!
//! One colour per strategy, fixed by its place in the list of all (Okabe and Ito's palette, made for the colour-blind);
//! one mark per choice of words among its parameters; numbers among its parameters are written at the points, which are
//! joined in the order of time. Bars show the median absolute deviation of the time and the truth's noise in the
//! error. The grey staircase is the Pareto front: nothing measured is both faster and more exact. Unresolved errors are drawn
//! hollow, at the value that the truth can just resolve.

mod chart;
mod legend;
mod series;
mod style;

use super::groups::Group;
use crate::{file_names, image_io::png_bytes, results::Results};
use chart::draw;
use plotters::prelude::*;
use series::{Series, series};
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
    /// Error against time of all strategies; `None` if nothing was both scored and timed.
    pub fn error_against_time(results: &Results, group: &Group) -> Option<Self> {
        let series = series(results, group);
        (!series.is_empty()).then(|| Self {
            file: file_names::plot(&group.scene, group.frame, &group.receivers),
            title: format!("{}: error against time", group.place()),
            threads: results.machine.threads,
            series,
        })
    }

    /// The plot as SVG.
    pub fn svg(&self) -> Result<String, String> {
        register_font();
        let mut svg = String::new();
        draw(&SVGBackend::with_string(&mut svg, SIZE).into_drawing_area(), 1, &self.title, self.threads, &self.series)?;
        Ok(svg)
    }

    /// The plot as a PNG of twice the size, so that it stays sharp on dense screens.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        register_font();
        let (width, height) = (2 * SIZE.0, 2 * SIZE.1);
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
        let plot = Plot::error_against_time(&example(), &only()).unwrap();
        let (svg, png) = (plot.svg().unwrap(), plot.png().unwrap());
        assert!(svg.trim_end().ends_with("</svg>") && svg.contains("relative RMSE") && svg.contains("Pareto front"));
        let image = image::load_from_memory(&png).unwrap();
        assert_eq!((image.width(), image.height()), (2 * SIZE.0, 2 * SIZE.1));
        assert!(Plot::error_against_time(&example(), &Group { frame: 1, ..only() }).is_none());
    }
}
