//! The medium below the surface of an object in a scene file.

use super::document::SubsurfaceTable;
use super::source::Source;
use crate::keys::Spanned;
use crate::{SceneError, Subsurface};

/// Refractive index of who doesn't say which: that of skin, milk and marble lies between 1.3 and 1.5 [Jensen2001, figure 5].
const DEFAULT_INDEX: f32 = 1.4;

/// The medium that a table describes.
pub(super) fn subsurface(source: &Source<'_>, table: &Spanned<SubsurfaceTable>) -> Result<Subsurface, SceneError> {
    let SubsurfaceTable { absorption, reduced_scattering, refractive_index } = table.get_ref();
    let medium = Subsurface {
        absorption: (*absorption).into(),
        reduced_scattering: (*reduced_scattering).into(),
        refractive_index: refractive_index.unwrap_or(DEFAULT_INDEX),
    };
    medium.validate().map_err(|SceneError { problem, remedy, .. }| {
        let error = source.error(table.span(), problem);
        match remedy {
            Some(remedy) => error.with_remedy(remedy),
            None => error,
        }
    })?;
    Ok(medium)
}
