//! Scenes of Mitsuba 3 \[Jakob2022\].
//!
//! [`export`] writes one frame, so that Mitsuba's answer is that of the truth, within noise:
//!
//! | here | there |
//! | --- | --- |
//! | meshes of a frame | `ply`, in world space, one for each texture of an object |
//! | diffuse surfaces, both faces | `twosided` `diffuse` |
//! | gloss; colours times a texture | `halfshade_lobes`, a plugin in Python that is written beside the scene |
//! | distant light | `constant`, or `envmap` |
//! | sun | a sphere so far away that it looks the same from everywhere |
//! | spherical lights | `sphere` with a `null` surface: they shine and hide nothing |
//! | b bounces | `volpath`, which sees through `null` surfaces, of depth b + 2, without Russian roulette |
//! | camera | `perspective`, its axes those of ours |
//!
//! Mitsuba interpolates between the texels of a map, whose radiance is constant here; so that they agree, every texel is
//! written several times (see `map_image`). Rows of its picture run from pole to pole, first and last on them, and its centre
//! column looks along +Z, ours along -Z.

mod element;
mod emitters;
mod export;
mod import;
mod import_materials;
mod import_shapes;
mod map_image;
mod materials;
mod ply;
mod xml;

pub use export::export;
pub use import::load;
