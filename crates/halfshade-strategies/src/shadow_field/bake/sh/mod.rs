//! Fields of spherical harmonics: soft shadows from few numbers.

pub(crate) mod projection;
pub(crate) mod shell;

use super::{
    meshes::{BakedObject, Baking, MeshRays, Source},
    projected::ProjectedField,
    vertices::{OwnRays, own_blocked, own_vectors},
};
use crate::shadow_field::{
    bake::field::Field,
    settings::{OwnOcclusion, Settings},
};
use halfshade_scene::{Mesh, Progress, Scene};
use halfshade_sh::{
    blocker_table::{BlockerTable, Quantity},
    zonal,
};
use halfshade_strategy::StrategyError;
use projection::ShBasis;
use shell::ShShell;
use std::f32::consts::FRAC_1_PI;

/// Fields of the scene's objects, and tables.
pub(crate) struct ShFields {
    pub(crate) bands: usize,
    pub(crate) source: Source,
    pub(crate) basis: ShBasis,
    pub(crate) own_kind: OwnOcclusion,
    pub(crate) table: BlockerTable,
    /// Clamped cosine over π by band, times the rotation's factor: ρ̂.
    pub(crate) cosine: Vec<f32>,
    /// With own occlusion by vertex and coefficient.
    pub(crate) objects: Vec<BakedObject<ShShell, Vec<f32>>>,
}

impl ShFields {
    /// Fields for every mesh of the scene.
    pub(crate) fn bake(
        baking: &Baking<'_>,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self, StrategyError> {
        let bands = settings.bands;
        let table = BlockerTable::build(bands, Quantity::BlockerMinusOne)
            .ok_or_else(|| StrategyError::Failed(format!("{bands} bands: there are kernels for 1 to 8")))?;
        let own_kind = settings.own;
        if scene.is_glossy() && (own_kind == OwnOcclusion::Projected || baking.source == Source::Together) {
            let problem =
                "own=projected and sampling=together hold the diffuse cosine; glossy reflectance needs others";
            return Err(StrategyError::Unsupported(problem.into()));
        }
        let are_values = |values: &[f32], count| values.len() == count && values.iter().all(|value| value.is_finite());
        let map = settings.map;
        let basis = ShBasis::new(bands, map);
        let key = |kind, mesh: &Mesh| baking.key(kind, mesh).value(&(bands, map));
        let field = |mesh: &MeshRays<'_>, bounds| {
            // As projected, so that another threshold needs no rays.
            let layout = baking.layout;
            let key = key("shadow-field-sh", mesh.mesh).value(&layout);
            let fits = |found: &ProjectedField<Vec<f32>>| {
                found.fits(bounds, layout, |vector| are_values(vector, bands * bands))
            };
            let projected = baking.cached(&key, fits, (layout.len(), progress), || {
                ProjectedField::new(&basis, (mesh.get().rays(), bounds), layout, progress)
            })?;
            Ok(Field::new(&basis, &projected, baking.thinning, baking.storage))
        };
        let own = |mesh: &MeshRays<'_>| {
            let key = key("own-occlusion-sh", mesh.mesh).value(&(own_kind == OwnOcclusion::Projected));
            let fits = |found: &Vec<f32>| are_values(found, mesh.mesh.positions.len() * bands * bands);
            baking.cached(&key, fits, (0, progress), || match own_kind {
                OwnOcclusion::Product => own_blocked(&basis, (mesh.mesh, mesh.get())).concat(),
                OwnOcclusion::Projected => own_transfer(&basis, (mesh.mesh, mesh.get())).concat(),
            })
        };
        let objects = baking.every_object(scene, progress, field, own)?;
        let cosine = zonal::reflectance(bands).into_iter().map(|value| value as f32).collect();
        Ok(Self { bands, source: baking.source, basis, own_kind, table, cosine, objects })
    }
}

/// Per vertex the visibility that its mesh leaves times the cosine over π.
fn own_transfer(basis: &ShBasis, mesh_and_rays: (&Mesh, &OwnRays)) -> Vec<Vec<f32>> {
    own_vectors(basis, mesh_and_rays, |direction, normal, blocked| {
        let cosine = direction.dot(normal).max(0.0);
        if cosine > 0.0 && !blocked() { FRAC_1_PI * cosine } else { 0.0 }
    })
}
