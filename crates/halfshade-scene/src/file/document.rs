//! A scene file as it is written: every key with its meaning, which editors and the guide tell too.

use crate::keys::Spanned;
use crate::scene::MAX_BOUNCES;
use crate::spheres::MAX_SPHERES;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Values keep their place in the file, so that errors can show it.
type At<T> = Option<Spanned<T>>;

/// Largest number of clusters of one object.
const MAX_CLUSTERS: usize = 100_000;

/// Largest number of frames.
pub(super) const MAX_FRAMES: usize = 1_000_000;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    /// Name in tables and pictures. Without it, the file's name.
    pub(super) name: Option<String>,
    /// Diffuse bounces of light; 0: direct light alone.
    #[serde(default)]
    #[schemars(range(min = 0, max = MAX_BOUNCES))]
    pub(super) bounces: usize,
    /// The scene as it is at that frame, held still: one frame, in which nothing moves.
    pub(super) still: At<usize>,
    /// Things that light falls on, at least one.
    #[serde(default)]
    pub(super) object: Vec<Spanned<ObjectTable>>,
    /// Light from infinitely far. Without it, constant light of 1, or none where there are lights.
    pub(super) environment: At<EnvironmentTable>,
    /// Spherical lights in the scene.
    #[serde(default)]
    pub(super) light: Vec<Spanned<LightTable>>,
    /// The camera of pictures. Without it, one that sees the whole scene.
    pub(super) camera: At<CameraTable>,
    /// Time line of what moves.
    pub(super) animation: Option<AnimationTable>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectTable {
    /// Mesh file (.obj, .ply, .gltf, .glb), relative to this file. An object has either a mesh or a shape.
    pub(super) mesh: At<String>,
    /// Built-in shape of unit size about the origin.
    #[schemars(extend("enum" = crate::builtin::SHAPES))]
    pub(super) shape: At<String>,
    /// Name in messages. Without it, that of the mesh or the shape.
    pub(super) name: Option<String>,
    /// Whether the mesh is shifted and scaled to unit size about the origin, as shapes are, before anything else moves it.
    pub(super) unit_size: At<bool>,
    /// The animation that deforms the object by skins or morph targets, by number or name; glTF only. Without it the mesh stays as
    /// the file has it.
    pub(super) animation: At<crate::mesh::Animation>,
    /// Encoding of the mesh's vertex colours. Without it, whole numbers (PLY's bytes) are sRGB, others linear.
    pub(super) colors: At<crate::mesh::ColorEncoding>,
    /// Reflected part of the light by channel, within [0, 1]. Without it 0.8.
    pub(super) albedo: At<[f32; 3]>,
    /// PNG or JPEG that multiplies the albedo, for meshes with texture coordinates; in place of the textures that a glTF brings.
    pub(super) albedo_texture: At<String>,
    /// Gloss beside the albedo. Without it there is none.
    pub(super) reflectance: At<ReflectanceTable>,
    /// Light that passes below the surface. Without it there is none.
    pub(super) subsurface: At<SubsurfaceTable>,
    /// Leaf spheres as a blocker; 0: receives only. Without it 64, of a plane 0.
    #[schemars(range(min = 0, max = MAX_SPHERES))]
    pub(super) spheres: Option<usize>,
    /// Aim of the sphere set. Without it `shadow`.
    pub(super) fit: Option<crate::SphereFit>,
    /// Receiver clusters; 0: left to the strategy.
    #[serde(default)]
    #[schemars(range(min = 0, max = MAX_CLUSTERS))]
    pub(super) clusters: usize,
    /// Shift in metres.
    pub(super) translate: At<[f32; 3]>,
    /// Axis and angle: `[x, y, z, degrees]`.
    pub(super) rotate: At<[f32; 4]>,
    /// Factor, positive.
    pub(super) scale: At<f32>,
    /// A movement, instead of the last three: poses by time, with straight ways between them.
    pub(super) keyframe: At<Vec<Spanned<KeyframeTable>>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ReflectanceTable {
    /// The model of reflectance.
    pub(super) model: Spanned<Model>,
    /// Reflected part of the light by channel.
    pub(super) specular: At<[f32; 3]>,
    /// Exponent of the cosine, at most 100000.
    pub(super) exponent: At<f32>,
    /// One to four lobes.
    pub(super) lobes: At<Vec<Spanned<LobeTable>>>,
    /// Picture that multiplies specular.
    pub(super) specular_texture: At<String>,
    /// Picture whose red channel multiplies the exponent, decoded as sRGB like all pictures.
    pub(super) exponent_texture: At<String>,
}

/// Models of reflectance, by the names that files give them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Model {
    /// Takes specular and exponent.
    Phong,
    /// Takes specular and exponent.
    ModifiedPhong,
    /// Takes lobes.
    Lafortune,
}

impl Model {
    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Phong => "phong",
            Self::ModifiedPhong => "modified-phong",
            Self::Lafortune => "lafortune",
        }
    }
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LobeTable {
    /// Factor by channel.
    pub(super) scale: [f32; 3],
    /// Weights of the cosines along tangent, bitangent and normal; `[-1, -1, 1]` is a mirror's direction.
    pub(super) axis: [f32; 3],
    /// Exponent, at most 100000.
    pub(super) exponent: f32,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SubsurfaceTable {
    /// Absorption per metre by channel, from 0 to 1e6.
    pub(super) absorption: [f32; 3],
    /// Reduced scattering per metre by channel, from 0 to 1e6.
    pub(super) reduced_scattering: [f32; 3],
    /// Refractive index, from 1 to 2.5. Without it 1.4.
    pub(super) refractive_index: Option<f32>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct KeyframeTable {
    /// Seconds from the start, rising from keyframe to keyframe.
    pub(super) time: Spanned<f64>,
    /// Shift in metres.
    pub(super) translate: At<[f32; 3]>,
    /// Axis and angle: `[x, y, z, degrees]`.
    pub(super) rotate: At<[f32; 4]>,
    /// Factor, positive.
    pub(super) scale: At<f32>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct EnvironmentTable {
    /// The same radiance from everywhere. An environment is one of constant, image, sky.
    pub(super) constant: At<[f32; 3]>,
    /// Light probe: Radiance HDR or OpenEXR, relative to this file.
    pub(super) image: At<String>,
    /// Places of directions on the image. Without it `latlong`.
    pub(super) projection: At<crate::light::Projection>,
    /// Azimuth of the image's centre, from -Z toward +X. Without it 0.
    pub(super) forward_degrees: At<f32>,
    /// Layer of an OpenEXR file that has several.
    pub(super) layer: At<String>,
    /// Largest radiance, for images that hold infinity, what isn't a number or negative values; the last two become 0.
    pub(super) clamp: At<f32>,
    /// A clear sky.
    pub(super) sky: At<SkyTable>,
    /// Turn of the environment around +Y. Without it 0.
    pub(super) turn_degrees_per_sec: At<f32>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SkyTable {
    /// Height of the sun above the horizon, more than 0, at most 90. Without it 45.
    pub(super) sun_elevation_degrees: Option<f32>,
    /// Azimuth of the sun, from -Z toward +X. Without it 135.
    pub(super) sun_azimuth_degrees: Option<f32>,
    /// Haziness: 2 is very clear, 3 clear, 6 hazy. Without it 3.
    #[schemars(range(min = 1.7, max = 10.0))]
    pub(super) turbidity: Option<f32>,
    /// Reflected part of the light by the ground. Without it 0.2.
    pub(super) ground_albedo: Option<[f32; 3]>,
    /// Whether the sun itself shines. Without it true.
    pub(super) sun: Option<bool>,
    /// Rows of the map, an even number. Without it 128.
    #[schemars(range(min = 8, max = 4096))]
    pub(super) resolution: Option<usize>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct LightTable {
    /// Place and size.
    pub(super) sphere: SphereTable,
    /// Emitted radiance by channel.
    pub(super) radiance: Spanned<[f32; 3]>,
    /// A movement: shifts and turns the centre about the origin, scales the radius.
    pub(super) keyframe: At<Vec<Spanned<KeyframeTable>>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SphereTable {
    /// Centre in metres.
    pub(super) center: Spanned<[f32; 3]>,
    /// Radius in metres.
    pub(super) radius: Spanned<f32>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    /// Place of the eye. Glossy receivers are seen from there.
    pub(super) eye: Spanned<[f32; 3]>,
    /// Point that is looked at.
    pub(super) target: Spanned<[f32; 3]>,
    /// Angle that the picture's height spans, between 0 and 180. Without it 40.
    pub(super) vertical_fov_degrees: At<f32>,
    /// Width and height in pixels. Without it 800 by 600.
    pub(super) resolution: At<[i64; 2]>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AnimationTable {
    /// Frames per second, at most 10000. Without it 30.
    pub(super) frames_per_sec: At<f64>,
    /// Number of frames. Without it, up to the last keyframe of objects, lights and glTF animations.
    #[schemars(range(min = 1, max = MAX_FRAMES))]
    pub(super) frame_count: Option<usize>,
}

/// Source of a mesh, and how it is read.
pub(super) type MeshKey = (PathBuf, bool, Option<crate::mesh::Animation>, Option<crate::mesh::ColorEncoding>);

/// Meshes read so far: objects that share all of the key share the mesh and its skin.
pub(super) type Meshes = BTreeMap<MeshKey, (Arc<crate::Mesh>, Option<Arc<crate::Skin>>)>;
