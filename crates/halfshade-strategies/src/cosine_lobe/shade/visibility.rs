//! The part of a light that spheres hide, as lobes [Meunier2009, 5.3].

use super::stages::{Repetition, Stage};
use crate::cosine_lobe::{
    bake::tables::Tables,
    kernel::{
        cell_lobes::{CellLobes, Shape},
        fractions::covered_fractions,
        mask::{Cell, Disc, Mask},
        receiver::Receiver,
        spheres::Spheres,
        square::Square,
    },
    settings::{Leaves, Order, Settings, Weights},
};

/// How much of a light spheres hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hidden {
    Nothing,
    /// The part that lobes tell.
    Part,
    All,
}

/// Working memory for one receiver and light at a time.
pub(crate) struct Visibility<'a, R> {
    settings: &'a Settings,
    tables: &'a Tables,
    repetition: R,
    discs: Vec<Disc>,
    mask: Mask,
    partial: Vec<Cell>,
}

impl<'a, R: Repetition> Visibility<'a, R> {
    pub(crate) fn new(settings: &'a Settings, tables: &'a Tables, repetition: R) -> Self {
        let mask = Mask::new(settings.depth);
        Self { settings, tables, repetition, discs: Vec::new(), mask, partial: Vec::new() }
    }

    /// How much `spheres` hide, and if a part, replaces `lobes` by it.
    pub(crate) fn find(
        &mut self,
        receiver: &Receiver,
        square: &Square,
        spheres: &Spheres,
        lobes: &mut CellLobes,
    ) -> Hidden {
        let repetition = self.repetition;
        let hidden = repetition.run(Stage::Mask, || self.find_mask(receiver, square, spheres));
        if hidden == Hidden::Part {
            repetition.run(Stage::MaskLobes, || self.find_lobes(square, lobes));
        }
        hidden
    }

    /// The cells that spheres cover.
    fn find_mask(&mut self, receiver: &Receiver, square: &Square, spheres: &Spheres) -> Hidden {
        if !self.find_discs(receiver, square, spheres) {
            return Hidden::All;
        }
        if self.discs.is_empty() {
            return Hidden::Nothing;
        }
        self.mask.clear();
        self.discs.iter().for_each(|disc| self.mask.splat(disc));
        if self.settings.leaves == Leaves::Conservative {
            self.mask.cover_touched();
        }
        if self.mask.join(&self.tables.cells.unlit) { Hidden::All } else { Hidden::Part }
    }

    /// The spheres in the way. `false` if one of them hides the light.
    fn find_discs(&mut self, receiver: &Receiver, square: &Square, spheres: &Spheres) -> bool {
        self.discs.clear();
        for (center, radius) in spheres.groups() {
            let (offset, radius) = receiver.adjusted(&center, radius, self.settings.rule.into());
            let mut hides = false;
            square.each_disc(&offset, radius, |disc| {
                hides |= disc.hides_light();
                self.discs.push(disc);
            });
            if hides {
                return false;
            }
        }
        true
    }

    /// The lobes of the mask.
    fn find_lobes(&mut self, square: &Square, lobes: &mut CellLobes) {
        let (settings, tables) = (self.settings, self.tables);
        let shape = match (settings.order, settings.weights) {
            (Order::LightFirst, _) => Shape::Part,
            (Order::Published, Weights::Fitted | Weights::Umbra) => Shape::Bounding(&tables.caps),
            (Order::Published, Weights::SolidAngle) => Shape::SolidAngle(&tables.caps),
        };
        let distance = square.distance();
        let weight = |level: usize| match settings.order {
            Order::LightFirst => 1.0,
            Order::Published => tables.weights.at(level, distance),
        };
        lobes.clear();
        self.mask.each_leaf(&tables.cells.unlit, |cell| {
            lobes.push(tables.cells.at(cell), cell.level, weight(cell.level), square, shape);
        });
        if settings.leaves == Leaves::Fraction {
            let of_level = weight(settings.depth);
            let partial = &mut self.partial;
            partial.clear();
            self.mask.each_partial(|cell| partial.push(cell));
            for cells in partial.chunks(8) {
                let mut eight = [cells[0]; 8];
                eight[..cells.len()].copy_from_slice(cells);
                let fractions = covered_fractions(&eight, &self.discs).to_array();
                for (&cell, fraction) in cells.iter().zip(fractions).filter(|(_, fraction)| *fraction > 0.0) {
                    lobes.push(tables.cells.at(cell), cell.level, of_level * fraction, square, shape);
                }
            }
        }
        lobes.flush(square, shape);
    }
}
