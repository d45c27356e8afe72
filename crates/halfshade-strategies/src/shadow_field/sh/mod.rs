//! Fields of spherical harmonics: soft shadows from few numbers.

mod fields;
mod gloss;
mod projection;
mod reach;
mod shade;
mod shell;

use super::{
    baking::{Baking, MeshRays, Source},
    details::{details, footprint},
    field::{Field, Projected},
    settings::{OwnOcclusion, Settings},
    vertices::{OwnRays, own_blocked, own_vectors},
};
use fields::{OwnKind, ShFields};
use halfshade_scene::{Environment, Frame, Mesh, Progress, RadianceMut, Receivers, Scene, light::DistantLight};
use halfshade_sh::{
    basis,
    blocker_table::{BlockerTable, Quantity},
    dispatch_bands, lat_long,
    rotation::ShRotation,
    zonal,
};
use halfshade_strategy::{Baked, Detail, Footprint, Prepared, StrategyError};
use projection::ShBasis;
use shell::MOST;
use std::f32::consts::FRAC_1_PI;

/// The basis of so many bands, for the tests of what all bases share.
#[cfg(test)]
pub(super) fn basis(bands: usize, side: usize) -> ShBasis {
    ShBasis::new(bands, side)
}

/// Fields for every mesh of the scene.
pub(super) fn bake(
    baking: &Baking<'_>,
    scene: &Scene,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Box<dyn Baked>, StrategyError> {
    let bands = settings.bands;
    let table = BlockerTable::build(bands, Quantity::BlockerMinusOne)
        .ok_or_else(|| StrategyError::Failed(format!("{bands} bands: there are kernels for 1 to 8")))?;
    let own_kind = match settings.own {
        OwnOcclusion::Projected => OwnKind::Transfer,
        OwnOcclusion::Product => OwnKind::Blocked,
    };
    if scene.is_glossy() && (own_kind == OwnKind::Transfer || baking.source == Source::Together) {
        let problem = "own=projected and sampling=together hold the diffuse cosine; glossy reflectance needs others";
        return Err(StrategyError::Unsupported(problem.into()));
    }
    let are_values = |values: &[f32], count| values.len() == count && values.iter().all(|value| value.is_finite());
    let map = settings.map;
    let basis = ShBasis::new(bands, map);
    let key = |kind, mesh: &Mesh| baking.key(kind, mesh).value(&(bands, map));
    let field = |of: &MeshRays<'_>, ball| {
        // As projected, so that another threshold needs no rays.
        let sampling = baking.sampling;
        let key = key("shadow-field-sh", of.mesh).value(&sampling);
        let fits =
            |found: &Projected<Vec<f32>>| found.is_of(ball, sampling, |vector| are_values(vector, bands * bands));
        let projected = baking.cached(&key, fits, (sampling.len(), progress), || {
            Projected::new(&basis, (of.get().rays(), ball), sampling, progress)
        })?;
        Ok(Field::new(&basis, &projected, baking.thinning, baking.storage))
    };
    let own = |of: &MeshRays<'_>| {
        let key = key("own-occlusion-sh", of.mesh).value(&(own_kind == OwnKind::Transfer));
        let fits = |found: &Vec<f32>| are_values(found, of.mesh.positions.len() * bands * bands);
        baking.cached(&key, fits, (0, progress), || match own_kind {
            OwnKind::Blocked => own_blocked(&basis, (of.mesh, of.get())).concat(),
            OwnKind::Transfer => own_transfer(&basis, (of.mesh, of.get())).concat(),
        })
    };
    let (known, arrangement) = baking.every_mesh(scene, progress, field, own)?;
    Ok(Box::new(ShFields {
        bands,
        source: baking.source,
        basis,
        own_kind,
        table,
        cosine: zonal::reflectance(bands).into_iter().map(|value| value as f32).collect(),
        known,
        light: Vec::new(),
        known_light: None,
        arrangement,
        rotations: Vec::new(),
    }))
}

/// Per vertex the visibility that its mesh leaves times the cosine over π.
fn own_transfer(basis: &ShBasis, of: (&Mesh, &OwnRays)) -> Vec<Vec<f32>> {
    own_vectors(basis, of, |direction, normal, blocked| {
        let cosine = direction.dot(normal).max(0.0);
        if cosine > 0.0 && !blocked() { FRAC_1_PI * cosine } else { 0.0 }
    })
}

/// Distant light, projected: coefficient by coefficient.
fn projected_light(bands: usize, environment: &Environment) -> Vec<[f32; 3]> {
    let count = bands * bands;
    let mut light: [Vec<f64>; 3] = match &environment.base {
        DistantLight::Constant(radiance) => {
            let one = basis::one(bands);
            radiance.to_array().map(|channel| one.iter().map(|value| f64::from(channel) * value).collect())
        }
        DistantLight::Map(map) => {
            let texels: Vec<[f32; 3]> = map.texels().iter().map(|texel| texel.to_array()).collect();
            lat_long::project(bands, map.width(), map.height(), &texels)
                .unwrap_or_else(|| std::array::from_fn(|_| vec![0.0; count]))
        }
    };
    if let Some(sun) = environment.sun {
        let versine = 2.0 * (0.5 * f64::from(sun.angular_radius)).sin().powi(2);
        let axis = sun.direction.as_dvec3().normalize().to_array();
        let cap = zonal::rotate_to_axis(&zonal::cap_from_versine(bands, versine), axis);
        for (channel, radiance) in light.iter_mut().zip(sun.radiance.to_array()) {
            channel.iter_mut().zip(&cap).for_each(|(sum, value)| *sum += f64::from(radiance) * value);
        }
    }
    (0..count).map(|i| std::array::from_fn(|channel| light[channel][i] as f32)).collect()
}

/// The rotation `object_from_light`, inverted, as blocks row by row.
fn light_from_object(bands: usize, object_from_light: [[f32; 3]; 3]) -> Vec<f32> {
    let rotation = ShRotation::new(bands, &object_from_light.map(|row| row.map(f64::from)));
    // The inverse is the transpose, of which columns are rows.
    (0..bands).flat_map(|l| rotation.block(l).iter().map(|&value| value as f32).collect::<Vec<_>>()).collect()
}

impl Baked for ShFields {
    fn footprint(&self) -> Footprint {
        footprint(&self.known, |own| size_of_val(own.as_slice()))
    }

    fn details(&self) -> Vec<Detail> {
        let count = self.bands * self.bands;
        details(&self.basis, &self.arrangement, &self.known, |field, place| {
            let mut sum = [0.0; MOST];
            field.add_at(place, std::slice::from_mut(&mut sum));
            sum[..count].to_vec()
        })
    }

    fn prepare(&mut self, frame: &Frame<'_>) -> Result<Box<dyn Prepared + '_>, StrategyError> {
        self.arrangement.prepare(frame)?;
        let environment = &frame.scene.environment;
        if !self.known_light.as_ref().is_some_and(|known| known.is_same_as(environment)) {
            self.light = projected_light(self.bands, environment);
            self.known_light = Some(environment.clone());
        }
        let rotations = self.arrangement.places.iter().map(|place| light_from_object(self.bands, place.rotation()));
        self.rotations = rotations.collect();
        Ok(Box::new(&*self))
    }
}

impl Prepared for &ShFields {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        // `bake` made sure that there is a kernel for this number of bands.
        let _: Option<()> = dispatch_bands!(self.bands, N => shade::shade::<N>(self, receivers, out));
    }
}
