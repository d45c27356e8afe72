//! Fields of Haar wavelets: shadows with edges, from many numbers of which most are nothing.
//!
//! What is hidden is kept as few wavelets on the faces of a cube; to be multiplied it becomes texels again. The product of
//! texels, one by one, is the wavelet triple product exactly (see `halfshade_sh::haar::product`), and texels can be
//! looked up in a cube that is turned, which wavelets can't.

mod fields;
mod light;
mod projection;
mod rows;
mod shade;
mod shell;
mod sparse;
mod sum;
mod turn;

use super::{
    baking::{Baking, MeshRays},
    details::{details, footprint},
    field::{Field, Projected},
    settings::Settings,
    vertices::own_blocked,
};
use fields::HaarFields;
use halfshade_scene::{Frame, Mesh, Progress, RadianceMut, Receivers, Scene};
use halfshade_strategy::{Baked, Detail, Footprint, Prepared, StrategyError};
use projection::HaarBasis;
use rayon::prelude::*;
use rows::Rows;
use shell::HaarShell;
use sparse::Sparse;
use sum::Sum;
use turn::Turn;

/// Fields for every mesh of the scene.
pub(super) fn bake(
    baking: &Baking<'_>,
    scene: &Scene,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Box<dyn Baked>, StrategyError> {
    let (face, kept) = (settings.face.next_power_of_two(), settings.kept);
    let coding = settings.coding;
    let basis = HaarBasis::new(face, kept, coding);
    let key = |kind, mesh: &Mesh| baking.key(kind, mesh).value(&(face, kept, coding, baking.storage));
    let field = |of: &MeshRays<'_>, ball| {
        // As stored: what is projected would fill disks.
        let sampling = baking.sampling;
        let key = key("shadow-field-haar", of.mesh).value(&(sampling, baking.thinning));
        let fits = |found: &Field<HaarShell>| {
            found.is_of(ball, sampling, |shell| shell.is_of(basis.cube, (coding, baking.storage)))
        };
        baking.cached(&key, fits, (sampling.len(), progress), || {
            let projected = Projected::new(&basis, (of.get().rays(), ball), sampling, progress);
            Field::new(&basis, &projected, baking.thinning, baking.storage)
        })
    };
    let own = |of: &MeshRays<'_>| {
        let fits = |found: &Rows| found.are_of(basis.cube, of.mesh.positions.len(), (coding, baking.storage));
        baking.cached(&key("own-occlusion-haar", of.mesh), fits, (0, progress), || {
            Rows::store(basis.cube, &own_blocked(&basis, (of.mesh, of.get())), baking.storage, coding)
        })
    };
    let (known, arrangement) = baking.every_mesh(scene, progress, field, own)?;
    let directions = std::array::from_fn(|axis| basis.directions.iter().map(|direction| direction[axis]).collect());
    Ok(Box::new(HaarFields {
        source: baking.source,
        basis,
        product: settings.product,
        directions,
        known,
        light: Default::default(),
        known_light: None,
        arrangement,
        turns: Vec::new(),
    }))
}

impl Baked for HaarFields {
    fn footprint(&self) -> Footprint {
        footprint(&self.known, Rows::bytes)
    }

    fn details(&self) -> Vec<Detail> {
        let read = |field: &Field<HaarShell>, place| {
            let mut sum = Sum::new(self.basis.cube);
            field.add_at(place, std::slice::from_mut(&mut sum));
            // All of it, as shading has it.
            Sparse::largest(&sum.values, self.basis.cube.len())
        };
        details(&self.basis, &self.arrangement, &self.known, read)
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.arrangement.prepare(frame)?;
        let environment = &frame.scene.environment;
        if !self.known_light.as_ref().is_some_and(|known| known.is_same_as(environment)) {
            self.light = light::distant(&self.basis, environment);
            self.known_light = Some(environment.clone());
        }
        let places = &self.arrangement.places;
        self.turns = places.par_iter().map(|place| Turn::new(&self.basis, place.rotation())).collect();
        Ok(Box::new(&*self))
    }
}

impl Prepared for &HaarFields {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        shade::shade(self, receivers, out);
    }
}
