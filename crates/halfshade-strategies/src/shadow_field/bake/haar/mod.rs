//! Fields of Haar wavelets: shadows with edges, from many numbers of which most are nothing.
//!
//! Occlusion is kept as few wavelets on the faces of a cube; to be multiplied it becomes texels again. The product of
//! texels, one by one, is the wavelet triple product exactly (see `halfshade_sh::haar::product`), and texels can be
//! looked up in a cube that is turned, which wavelets can't.

pub(crate) mod projection;
pub(crate) mod rows;
pub(crate) mod shell;
pub(crate) mod sparse;
pub(crate) mod sum;

use super::{
    field::Field,
    meshes::{BakedObject, Baking, MeshRays, Source},
    projected::ProjectedField,
    vertices::own_blocked,
};
use crate::shadow_field::settings::{Product, Settings};
use halfshade_scene::{Mesh, Progress, Scene};
use halfshade_strategy::StrategyError;
use projection::HaarBasis;
use rows::Rows;
use shell::HaarShell;

/// Fields of the scene's objects, and the cube that they are on.
pub(crate) struct HaarFields {
    pub(crate) source: Source,
    pub(crate) basis: HaarBasis,
    pub(crate) product: Product,
    /// x, y and z of the texels' directions.
    pub(crate) directions: [Vec<f32>; 3],
    /// With own occlusion by vertex.
    pub(crate) objects: Vec<BakedObject<HaarShell, Rows>>,
}

impl HaarFields {
    /// Fields for every mesh of the scene.
    pub(crate) fn bake(
        baking: &Baking<'_>,
        scene: &Scene,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self, StrategyError> {
        let (face, kept) = (settings.face.next_power_of_two(), settings.kept);
        let coding = settings.coding;
        let basis = HaarBasis::new(face, kept, coding);
        let key = |kind, mesh: &Mesh| baking.key(kind, mesh).value(&(face, kept, coding, baking.storage));
        let field = |mesh: &MeshRays<'_>, bounds| {
            // As stored: what is projected would fill disks.
            let layout = baking.layout;
            let key = key("shadow-field-haar", mesh.mesh).value(&(layout, baking.thinning));
            let fits = |found: &Field<HaarShell>| {
                found.fits(bounds, layout, |shell| shell.fits(basis.cube, (coding, baking.storage)))
            };
            baking.cached(&key, fits, (layout.len(), progress), || {
                let projected = ProjectedField::new(&basis, (mesh.get().rays(), bounds), layout, progress);
                Field::new(&basis, &projected, baking.thinning, baking.storage)
            })
        };
        let own = |mesh: &MeshRays<'_>| {
            let fits = |found: &Rows| found.fit(basis.cube, mesh.mesh.positions.len(), (coding, baking.storage));
            baking.cached(&key("own-occlusion-haar", mesh.mesh), fits, (0, progress), || {
                Rows::store(basis.cube, &own_blocked(&basis, (mesh.mesh, mesh.get())), baking.storage, coding)
            })
        };
        let objects = baking.every_object(scene, progress, field, own)?;
        let directions = std::array::from_fn(|axis| basis.directions.iter().map(|direction| direction[axis]).collect());
        Ok(Self { source: baking.source, basis, product: settings.product, directions, objects })
    }
}
