//! The gloss of an object in a scene file.

use super::document::{LobeTable, Model, ReflectanceTable};
use super::source::Source;
use crate::keys::Spanned;
use crate::{GlossVariation, LafortuneLobe, Mesh, Reflectance, SceneError, Texture};
use glam::Vec3;
use std::sync::Arc;

type Result<T> = std::result::Result<T, SceneError>;

/// The model that a table describes, for a surface of this albedo.
pub(super) fn reflectance(source: &Source<'_>, table: &ReflectanceTable, albedo: Vec3) -> Result<Reflectance> {
    let model = *table.model.get_ref();
    let misplaced = |span, what: &str, instead: &str| {
        source
            .error(span, format!("{what} doesn't belong to model `{}`", model.name()))
            .with_remedy(format!("give {instead}"))
    };
    let missing = |what: &str| source.error(table.model.span(), format!("model `{}` needs {what}", model.name()));
    match model {
        Model::Phong | Model::ModifiedPhong => {
            if let Some(lobes) = &table.lobes {
                return Err(misplaced(lobes.span(), "lobes", "specular and exponent"));
            }
            let specular = table.specular.as_ref().ok_or_else(|| missing("specular"))?;
            let exponent = table.exponent.as_ref().ok_or_else(|| missing("exponent"))?;
            let with = |specular: Vec3, exponent: f32| match model {
                Model::Phong => Reflectance::Phong { specular, exponent },
                _ => Reflectance::ModifiedPhong { specular, exponent },
            };
            // One at a time, so that the error stands where the mistake is.
            with(Vec3::ZERO, *exponent.get_ref())
                .validate(albedo)
                .map_err(|error| source.error(exponent.span(), error.problem))?;
            let reflectance = with(Vec3::from(*specular.get_ref()), *exponent.get_ref());
            reflectance.validate(albedo).map_err(|error| source.error(specular.span(), error.problem))?;
            Ok(reflectance)
        }
        Model::Lafortune => {
            let scalar = table.specular.as_ref().map(Spanned::span).or(table.exponent.as_ref().map(Spanned::span));
            if let Some(span) = scalar {
                return Err(misplaced(span, "specular or exponent", "lobes"));
            }
            let lobes = table.lobes.as_ref().ok_or_else(|| missing("lobes"))?;
            let lobe = |table: &Spanned<LobeTable>| {
                let LobeTable { scale, axis, exponent } = *table.get_ref();
                LafortuneLobe { scale: Vec3::from(scale), axis: Vec3::from(axis), exponent }
            };
            for table in lobes.get_ref() {
                let alone = Reflectance::Lafortune { lobes: vec![lobe(table)] };
                alone.validate(albedo).map_err(|error| source.error(table.span(), error.problem))?;
            }
            let all = Reflectance::Lafortune { lobes: lobes.get_ref().iter().map(lobe).collect() };
            all.validate(albedo).map_err(|error| source.error(lobes.span(), error.problem))?;
            Ok(all)
        }
    }
}

/// The textures that vary it, if there are some, for `mesh` called `name`.
pub(super) fn variation(
    source: &Source<'_>,
    table: &ReflectanceTable,
    mesh: &Mesh,
    name: &str,
) -> Result<Option<Arc<GlossVariation>>> {
    let texture = |key: &str, path: &Option<Spanned<String>>| -> Result<Option<Arc<Texture>>> {
        path.as_ref().map(|path| source.texture(key, path, mesh, name)).transpose()
    };
    let specular = texture("specular_texture", &table.specular_texture)?;
    let exponent = texture("exponent_texture", &table.exponent_texture)?;
    let varies = specular.is_some() || exponent.is_some();
    Ok(varies.then(|| Arc::new(GlossVariation { vertices: Vec::new(), specular, exponent })))
}
