//! Scene files, and scenes around a mesh file.
//!
//! A scene file is TOML. Besides the keys below, none is allowed; one that is unknown is an error that names its line
//! and the keys there are. Paths are relative to the scene file. Places, radii and what scales make of meshes stay within
//! 1e12, so that single precision can multiply them.
//!
//! ```toml
//! name = "bunny"                    # default: the file's name
//! bounces = 0                       # diffuse bounces of light asked for; 0: direct light alone
//! # still = 60                      # the scene as it is at that frame, held still: one frame, in which nothing moves
//!
//! [[object]]
//! mesh = "bunny.obj"                # or shape = "sphere"|"plane"|"box"|..: see builtin::SHAPES
//! name = "bunny"                    # default: the mesh's or the shape's name
//! # animation = 0                   # or = "walk": the animation, by number or name, of a glTF whose skins or morph targets
//! #                                 # deform the object; without it the mesh stays as the file has it. See mesh::load_animated
//! # colors = "srgb"                 # or "linear": how the mesh's vertex colours are encoded; default: whole numbers (PLY's
//! #                                 # bytes) are sRGB, floating-point ones and a glTF's linear
//! albedo = [0.7, 0.5, 0.4]          # in [0, 1]; default 0.8
//! albedo_texture = "bunny.png"      # PNG or JPEG, multiplies the albedo; for meshes with texture coordinates, in place
//!                                   # of the textures that a glTF brings
//! # reflectance = { model = "phong"|"modified-phong", specular = [0.3, 0.3, 0.3], exponent = 50 }
//! # reflectance = { model = "lafortune", lobes = [{ scale = [0.3, 0.3, 0.3], axis = [-1, -1, 1], exponent = 50 }] }
//! #                                 # gloss beside the albedo, see Reflectance; default: none. Textures vary it:
//! #                                 # specular_texture = "s.png" multiplies the scale, exponent_texture = "e.png" (its red
//! #                                 # channel, sRGB as all) the exponent
//! # subsurface = { absorption = [2.1, 4.1, 7.1], reduced_scattering = [2190, 2620, 3000], refractive_index = 1.5 }
//! #                                 # light that passes below the surface, see Subsurface: per metre, from 0 to 1e6, and the
//! #                                 # index from 1 to 2.5, default 1.4. The albedo tints it. Default: none
//! spheres = 64                      # leaf spheres, at most 2000; 0: receives only. Default 64, of a plane 0
//! fit = "shadow"                    # default; or "bounding": spheres that leave no part bare, see spheres::SphereFit
//! clusters = 0                      # receiver clusters; 0: left to the strategy
//! translate = [0, 0, 0]
//! rotate = [0, 1, 0, 30]            # axis, degrees
//! scale = 1
//! # instead of the last three, a movement:
//! # keyframe = [{ time = 0, translate = [0, 0, 0] }, { time = 2, rotate = [0, 1, 0, 90], scale = 2 }]
//!
//! [environment]                     # default: constant [1, 1, 1], or none where there are lights
//! constant = [1, 1, 1]
//! # or image = "probe.hdr", projection = "latlong"|"angular", forward_degrees = 0: the centre, from -Z toward +X;
//! #    layer = "beauty" of an OpenEXR file with several; clamp = 65504: the largest radiance, for images that hold
//! #    infinity, what isn't a number or negative ones, the last two of which become 0
//! # or sky = { sun_elevation_degrees = 45, sun_azimuth_degrees = 135, turbidity = 3, ground_albedo = [0.2, 0.2, 0.2],
//! #            sun = true, resolution = 128 }
//! turn_degrees_per_sec = 0          # around +Y
//!
//! [[light]]
//! sphere = { center = [0, 3, 0], radius = 0.5 }
//! radiance = [10, 10, 10]
//! # keyframe = [..]: moves the centre, scales the radius
//!
//! [camera]                          # default: the whole scene
//! eye = [0, 1, 4]
//! target = [0, 0.5, 0]
//! vertical_fov_degrees = 40
//! resolution = [800, 600]
//!
//! [animation]
//! frames_per_sec = 30
//! frame_count = 90                  # default: up to the last keyframe, of objects, lights and glTF animations
//! ```

mod build;
mod changes;
mod document;
mod environment;
mod framing;
mod mesh_file;
mod reflectance;
mod source;
mod subsurface;
mod values;

pub use build::DEFAULT_SPHERE_COUNT;
pub use changes::Change;
pub(crate) use framing::camera_that_sees;
pub use mesh_file::from_mesh;
pub(crate) use source::stem;

use crate::{Scene, SceneError, text};
use changes::changed;
use source::Source;
use std::path::Path;

/// Reads a scene file and all that it names; sphere sets are not built yet.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    load_changed(path, &[])
}

/// The same of a file in which some values are others.
///
/// # Errors
/// Those of the file, and a change whose path leads nowhere.
pub fn load_changed(path: &Path, changes: &[Change]) -> Result<Scene, SceneError> {
    let mut text = text::read(path)?;
    if !changes.is_empty() {
        text = changed(&text, changes).map_err(|error| error.in_file(path))?;
    }
    let source = Source::new(path, &text);
    let document = source.parse()?;
    build::scene(&source, document)
}
