//! A scene file as it is written: every key, none checked yet.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use toml::Spanned;

/// Values keep their place in the file, so that errors can name the line.
type At<T> = Option<Spanned<T>>;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Document {
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) object: Vec<Spanned<ObjectTable>>,
    pub(super) environment: At<EnvironmentTable>,
    #[serde(default)]
    pub(super) light: Vec<Spanned<LightTable>>,
    pub(super) camera: At<CameraTable>,
    pub(super) animation: Option<AnimationTable>,
    pub(super) bounces: At<i64>,
    pub(super) still: At<i64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectTable {
    pub(super) name: Option<String>,
    pub(super) mesh: At<String>,
    pub(super) shape: At<String>,
    pub(super) animation: At<crate::mesh::Animation>,
    pub(super) colors: At<crate::mesh::ColorEncoding>,
    pub(super) albedo: At<[f32; 3]>,
    pub(super) albedo_texture: At<String>,
    pub(super) reflectance: At<ReflectanceTable>,
    pub(super) subsurface: At<SubsurfaceTable>,
    pub(super) spheres: At<i64>,
    pub(super) fit: Option<crate::SphereFit>,
    pub(super) clusters: At<i64>,
    pub(super) translate: At<[f32; 3]>,
    pub(super) rotate: At<[f32; 4]>,
    pub(super) scale: At<f32>,
    pub(super) keyframe: At<Vec<Spanned<KeyframeTable>>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReflectanceTable {
    pub(super) model: Spanned<String>,
    pub(super) specular: At<[f32; 3]>,
    pub(super) exponent: At<f32>,
    pub(super) lobes: At<Vec<Spanned<LobeTable>>>,
    pub(super) specular_texture: At<String>,
    pub(super) exponent_texture: At<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LobeTable {
    pub(super) scale: [f32; 3],
    pub(super) axis: [f32; 3],
    pub(super) exponent: f32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SubsurfaceTable {
    pub(super) absorption: [f32; 3],
    pub(super) reduced_scattering: [f32; 3],
    pub(super) refractive_index: Option<f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KeyframeTable {
    pub(super) time: Spanned<f64>,
    pub(super) translate: At<[f32; 3]>,
    pub(super) rotate: At<[f32; 4]>,
    pub(super) scale: At<f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EnvironmentTable {
    pub(super) constant: At<[f32; 3]>,
    pub(super) image: At<String>,
    pub(super) projection: At<String>,
    pub(super) forward_degrees: At<f32>,
    pub(super) layer: At<String>,
    pub(super) clamp: At<f32>,
    pub(super) sky: At<SkyTable>,
    pub(super) turn_degrees_per_sec: At<f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SkyTable {
    pub(super) sun_elevation_degrees: Option<f32>,
    pub(super) sun_azimuth_degrees: Option<f32>,
    pub(super) turbidity: Option<f32>,
    pub(super) ground_albedo: Option<[f32; 3]>,
    pub(super) sun: Option<bool>,
    pub(super) resolution: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightTable {
    pub(super) sphere: SphereTable,
    pub(super) radiance: Spanned<[f32; 3]>,
    pub(super) keyframe: At<Vec<Spanned<KeyframeTable>>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SphereTable {
    pub(super) center: Spanned<[f32; 3]>,
    pub(super) radius: Spanned<f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    pub(super) eye: Spanned<[f32; 3]>,
    pub(super) target: Spanned<[f32; 3]>,
    pub(super) vertical_fov_degrees: At<f32>,
    pub(super) resolution: At<[i64; 2]>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AnimationTable {
    pub(super) frames_per_sec: At<f64>,
    pub(super) frame_count: At<i64>,
}

/// Source of a mesh, and how it is read.
pub(super) type MeshKey = (PathBuf, Option<crate::mesh::Animation>, Option<crate::mesh::ColorEncoding>);

/// Meshes read so far: objects that share all of the key share the mesh and its skin.
pub(super) type Meshes = BTreeMap<MeshKey, (Arc<crate::Mesh>, Option<Arc<crate::Skin>>)>;
