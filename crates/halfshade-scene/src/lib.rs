//! Everything the strategies and the truth share: meshes, materials, lights, cameras, poses, receivers, sphere sets.
//!
//! World space is right-handed with +Y up, in metres. Radiance is linear and scene-referred, Rec. 709 primaries.

pub mod builtin;
pub mod cache;
pub mod camera;
pub mod clusters;
pub mod deformed;
pub mod error;
pub mod eye_lobes;
pub mod file;
pub mod frame;
pub mod gloss;
pub mod input;
pub mod light;
pub mod lobe;
pub mod material;
pub mod mesh;
pub mod morph;
pub mod motion;
pub mod once;
pub mod pose;
pub mod progress;
pub mod receivers;
pub mod reflectance;
pub mod scene;
pub mod skin;
pub mod spheres;
pub mod surface_point;
pub mod text;
pub mod texture;

pub use cache::{Cache, CacheOutcome};
pub use camera::Camera;
pub use clusters::{Clusters, cluster};
pub use deformed::Deformed;
pub use error::SceneError;
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
pub use once::once;
pub use pose::Pose;
pub use progress::Progress;
pub use receivers::{RadianceBuffer, RadianceMut, ReceiverBuffer, ReceiverPoint, Receivers};
pub use reflectance::{LafortuneLobe, Reflectance};
pub use scene::{Object, Scene};
pub use skin::{Joint, Skin};
pub use spheres::{Sphere, SphereSet};
pub use surface_point::{SurfacePoint, VertexWeights};
pub use texture::Texture;
