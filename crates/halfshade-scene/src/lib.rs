//! Everything the strategies and the truth share: meshes, materials, lights, cameras, poses, receivers, sphere sets.
//!
//! World space is right-handed with +Y up, in metres. Radiance is linear and scene-referred, Rec. 709 primaries.
//!
//! A [`Scene`] is made in code, by [`builtin`], or from a file ([`file::load`]); a [`Frame`] is the scene at one instant:
//!
//! ```
//! use glam::Vec3;
//! use halfshade_scene::{Environment, Object, Pose, ReceiverBuffer, Scene, builtin::shapes};
//!
//! let ball = Object::new("ball", shapes::sphere(4)).pose(Pose::from_translation(Vec3::Y));
//! let scene = Scene::at_rest("a ball", vec![ball], Environment::constant(Vec3::ONE));
//! let receivers = ReceiverBuffer::vertices(&scene.frame(0));
//! assert_eq!(receivers.len(), scene.vertex_count());
//! assert!((receivers.view().position_at(0).distance(Vec3::Y) - 1.0).abs() < 1e-6);
//! ```

pub mod builtin;
pub mod cache;
pub mod camera;
pub mod clusters;
pub mod deformed;
pub mod doubts;
pub mod error;
pub mod exchange;
mod exr_file;
pub mod eye_lobes;
pub mod file;
pub mod frame;
pub mod gloss;
pub mod input;
pub mod keys;
pub mod light;
pub mod lobe;
pub mod material;
pub mod mesh;
pub mod morph;
pub mod motion;
pub mod object;
pub mod once;
pub mod pose;
pub mod progress;
pub mod receivers;
pub mod reflectance;
pub mod scene;
pub mod skin;
pub mod spheres;
mod still;
pub mod subsurface;
pub mod surface_point;
pub mod text;
pub mod texture;

pub use cache::{Cache, CacheOutcome};
pub use camera::Camera;
pub use clusters::{Clusters, cluster};
pub use deformed::Deformed;
pub use error::SceneError;
pub use exr_file::{ExrFacts, exr_bytes};
pub use eye_lobes::EyeLobes;
pub use frame::{Frame, Placement};
pub use gloss::{Gloss, GlossVariation};
pub use input::InputFile;
pub use light::{Environment, SphereLight};
pub use lobe::{Lobe, Lobes};
pub use material::Material;
pub use mesh::Mesh;
pub use morph::{MorphShift, MorphTarget};
pub use motion::Motion;
pub use object::Object;
pub use once::once;
pub use pose::Pose;
pub use progress::Progress;
pub use receivers::{RadianceBuffer, RadianceMut, ReceiverBuffer, ReceiverPoint, Receivers};
pub use reflectance::{LafortuneLobe, Reflectance};
pub use scene::Scene;
pub use skin::{Joint, Skin};
pub use spheres::{Sphere, SphereFit, SphereSet};
pub use subsurface::Subsurface;
pub use surface_point::{SurfacePoint, VertexWeights};
pub use texture::Texture;
