//! Base colour textures of a document, and what their alpha cuts out.

use super::{Buffers, uri};
use crate::mesh::AlphaMask;
use crate::texture::{Filter, Wrap};
use crate::{SceneError, Texture};
use ::gltf::Document;
use ::gltf::image::{Image, Source};
use ::gltf::texture::{MagFilter, MinFilter, Sampler, WrappingMode};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// Alpha of a texture, and its least and largest value.
type Alpha = Option<(Arc<Texture>, [f32; 2])>;

/// The base colour textures met so far, by number.
pub(super) struct Textures<'a> {
    document: &'a Document,
    pub(super) list: Vec<Arc<Texture>>,
    pub(super) masks: Vec<AlphaMask>,
    /// The place in `list` of each texture of the document; of `None`, that of a white one, for parts without.
    number_of: HashMap<Option<usize>, usize>,
    /// Alpha of each texture read so far.
    alpha_of: HashMap<usize, Alpha>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(document: &'a Document) -> Self {
        let (list, masks, number_of, alpha_of) = Default::default();
        Self { document, list, masks, number_of, alpha_of }
    }

    /// Whether any texture of the document was asked for.
    pub(super) fn is_used(&self) -> bool {
        self.number_of.keys().any(Option::is_some)
    }

    /// The number of a texture, which is read when first asked for; without one, that of a white texture.
    pub(super) fn number(
        &mut self,
        texture: Option<::gltf::Texture<'_>>,
        buffers: &Buffers,
    ) -> Result<usize, SceneError> {
        let key = texture.as_ref().map(::gltf::Texture::index);
        if let Some(number) = self.number_of.get(&key) {
            return Ok(*number);
        }
        let read = match texture {
            None => Texture::new(1, 1, vec![Vec3::ONE])?,
            Some(texture) => {
                let sampler = texture.sampler();
                let sampled = |texture: Texture| texture.wrapped(wrap_of(&sampler)).filtered(filter_of(&sampler));
                let (color, alpha) = decoded(&self.image(&texture)?, buffers)?;
                let alpha = alpha.map(|alpha| {
                    let bounds = alpha.red_bounds();
                    (Arc::new(sampled(alpha)), bounds)
                });
                self.alpha_of.insert(texture.index(), alpha);
                sampled(color)
            }
        };
        self.list.push(Arc::new(read));
        self.number_of.insert(key, self.list.len() - 1);
        Ok(self.list.len() - 1)
    }

    /// Alpha of a texture; `None` where it is one all over.
    pub(super) fn alpha(&mut self, texture: &::gltf::Texture<'_>, buffers: &Buffers) -> Result<Alpha, SceneError> {
        self.number(Some(texture.clone()), buffers)?;
        Ok(self.alpha_of.get(&texture.index()).cloned().flatten())
    }

    /// The number of a mask.
    pub(super) fn mask(&mut self, texture: Option<Arc<Texture>>, cutoff: f32) -> usize {
        let is_same = |mask: &AlphaMask| {
            mask.cutoff == cutoff
                && match (&mask.texture, &texture) {
                    (Some(a), Some(b)) => Arc::ptr_eq(a, b),
                    (a, b) => a.is_none() && b.is_none(),
                }
        };
        self.masks.iter().position(is_same).unwrap_or_else(|| {
            self.masks.push(AlphaMask { texture, cutoff });
            self.masks.len() - 1
        })
    }

    /// The image of a texture: its own, else the one that an extension names.
    fn image(&self, texture: &::gltf::Texture<'_>) -> Result<Image<'a>, SceneError> {
        if let Some(image) = texture.source() {
            let found = self.document.images().nth(image.index());
            return found.ok_or_else(|| nowhere(texture.index(), image.index())).and_then(|image| self.sourced(image));
        }
        let sources = texture.extensions().into_iter().flatten();
        let named = sources.filter_map(|(name, value)| Some((name, value.get("source")?.as_u64()?))).next();
        let Some((name, number)) = named else {
            return Err(SceneError::new(format!("texture {} names no image", texture.index()))
                .with_remedy("export again with PNG or JPEG textures"));
        };
        let image = usize::try_from(number).ok().and_then(|number| self.document.images().nth(number));
        image
            .ok_or_else(|| {
                SceneError::new(format!(
                    "texture {} names image {number} by {name}, but there is none",
                    texture.index()
                ))
            })
            .and_then(|image| self.sourced(image))
    }

    /// The image, unless it doesn't say where its data are: asked for its source, the parser would panic.
    fn sourced(&self, image: Image<'a>) -> Result<Image<'a>, SceneError> {
        let number = image.index();
        let Some(raw) = self.document.as_json().images.get(number) else { return Ok(image) };
        match (&raw.buffer_view, &raw.uri) {
            (None, None) => Err(SceneError::new(format!("image {number} names neither a file nor a view of a buffer"))
                .with_remedy("export again, or give it a `uri`")),
            (Some(_), _) if raw.mime_type.is_none() => {
                Err(SceneError::new(format!("image {number} lies in a buffer, but doesn't say as what"))
                    .with_remedy("add `\"mimeType\": \"image/png\"` or `\"image/jpeg\"` to it"))
            }
            _ => Ok(image),
        }
    }
}

/// Wrapping of a sampler along rows and columns.
fn wrap_of(sampler: &Sampler<'_>) -> [Wrap; 2] {
    [sampler.wrap_s(), sampler.wrap_t()].map(|mode| match mode {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    })
}

/// Filter by which a sampler magnifies: where it doesn't say, as it minifies.
fn filter_of(sampler: &Sampler<'_>) -> Filter {
    use MinFilter::{Nearest, NearestMipmapLinear, NearestMipmapNearest};
    match (sampler.mag_filter(), sampler.min_filter()) {
        (Some(MagFilter::Nearest), _) | (None, Some(Nearest | NearestMipmapLinear | NearestMipmapNearest)) => {
            Filter::Nearest
        }
        _ => Filter::Linear,
    }
}

fn nowhere(texture: usize, image: usize) -> SceneError {
    SceneError::new(format!("texture {texture} names image {image}, but there is none"))
}

/// Colour and alpha of an image.
fn decoded(image: &Image<'_>, buffers: &Buffers) -> Result<(Texture, Option<Texture>), SceneError> {
    let label = match image.source() {
        Source::Uri { uri, .. } => format!("image {} ({})", image.index(), uri::label(uri)),
        Source::View { .. } => match image.name() {
            Some(name) => format!("image {} (`{name}`)", image.index()),
            None => format!("image {}", image.index()),
        },
    };
    let read = bytes(image.source(), buffers).map_err(|error| {
        let problem = format!("{label} cannot be read: {}", error.problem);
        SceneError { problem, ..error }
    });
    read.and_then(|bytes| {
        Texture::decode_with_alpha(&bytes)
            .map_err(|error| SceneError { problem: format!("{label}: {}", error.problem), ..error })
    })
}

/// An encoded image: a view of a buffer, a data URI, or a file beside the document.
fn bytes(source: Source<'_>, buffers: &Buffers) -> Result<Vec<u8>, SceneError> {
    match source {
        Source::View { view, .. } => {
            buffers.view(&view).map(<[u8]>::to_vec).ok_or_else(|| SceneError::new("it reaches beyond its buffer"))
        }
        Source::Uri { uri, .. } => uri::bytes(uri, &buffers.folder),
    }
}
