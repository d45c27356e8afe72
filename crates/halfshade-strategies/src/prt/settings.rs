//! Everything that can be set.

use halfshade_sh::window::Window;
use halfshade_strategy::{Params, Stage, choice, settings};

choice! {
    /// The light that transfer vectors know of.
    pub(crate) enum TransferKind {
        /// from infinitely far, hidden by nothing
        Unshadowed = "unshadowed",
        /// from infinitely far, hidden by all objects
        Shadowed = "shadowed",
        /// the same, and what surfaces reflect, as many bounces as the scene asks for
        Interreflected = "interreflected",
    }
}

choice! {
    /// How transfer vectors are stored.
    pub(crate) enum Compression {
        /// as they are
        None = "none",
        /// by principal components of all of them
        Pca = "pca",
        /// by clusters of vectors that are taken as equal
        Vq = "vq",
        /// by principal components of each of several clusters
        Cpca = "cpca",
    }
}

choice! {
    /// Factors of bands against ringing.
    pub(crate) enum WindowKind {
        /// none
        None = "none",
        /// (1 + cos(π l/n))/2 of band l of n
        Hann = "hann",
        /// sin(π l/n)/(π l/n)
        Lanczos = "lanczos",
        /// the least window, of those of the squared Laplacian, that leaves light nowhere negative
        Nonnegative = "nonnegative",
    }
}

choice! {
    /// Objects that move against the others, or deform.
    pub(crate) enum Moving {
        /// scenes with any are refused
        Refuse = "refuse",
        /// they receive light from a volume of what arrives among the others, and hide none
        Volume = "volume",
    }
}

choice! {
    /// The place of a window. `hann` and `lanczos` give the same on light and on transfer, `nonnegative` doesn't.
    pub(crate) enum WindowOn {
        /// light
        Light = "light",
        /// transfer vectors, not matrices
        Transfer = "transfer",
        /// both
        Both = "both",
    }
}

choice! {
    /// Functions that light is made of.
    pub(crate) enum LightBasis {
        /// spherical harmonics of all bands
        Sh = "sh",
        /// three bands, of the third what is symmetric about the axis of the second; `bands` is not read
        Zh3 = "zh3",
        /// two bands, and a third guessed from them; `bands` is not read
        GuessedZh3 = "guessed-zh3",
    }
}

/// Where it errs, from what is found last to what is found first.
pub(crate) const STAGES: &[Stage] = &[
    Stage { name: "compression", exact: "compression=none" },
    Stage { name: "points of local lights", exact: "lamp-steps=0" },
    Stage { name: "window", exact: "window=none" },
    Stage { name: "basis of the light", exact: "light=sh" },
    Stage { name: "rays", exact: "directions=16384" },
    Stage { name: "bands", exact: "bands=8" },
];

settings! {
    /// Everything that can be set.
    pub(crate) struct Settings {
        /// bands of light and transfer
        "bands" => bands: usize = 4, in 1..=8, levels ["2", "3", "4", "5", "6", "8"];
        /// light that transfer vectors know of
        "transfer" => transfer: TransferKind = TransferKind::Interreflected;
        /// rays from each vertex when transfer is baked
        "directions" => directions: usize = 1024, in 16..=65_536;
        /// how transfer vectors are stored
        "compression" => compression: Compression = Compression::None;
        /// clusters of vectors, for `vq` and `cpca`
        "clusters" => clusters: usize = 256, in 1..=4096;
        /// principal components of each cluster, for `pca` and `cpca`
        "components" => components: usize = 8, in 0..=192;
        /// what becomes of objects that move against the others
        "moving" => moving: Moving = Moving::Refuse;
        /// steps of the volume along its longest side
        "volume-steps" => volume_steps: usize = 12, in 1..=64;
        /// steps along the scene's longest side between points at which local lights are known; 0: at every receiver
        "lamp-steps" => lamp_steps: usize = 0, in 0..=64;
        /// factors of bands against ringing
        "window" => window: WindowKind = WindowKind::None;
        /// what the window is on
        "window-on" => window_on: WindowOn = WindowOn::Light;
        /// functions that light is made of
        "light" => light: LightBasis = LightBasis::Sh;
    }
}

impl Settings {
    /// Settings as they are meant: zonal light has three bands.
    pub(crate) fn of(params: &Params) -> Self {
        let settings = Self::read(params);
        let bands = if settings.light == LightBasis::Sh { settings.bands } else { halfshade_sh::zh3::BANDS };
        Self { bands, ..settings }
    }
}

impl WindowKind {
    /// The window, where it is the same for all functions.
    pub(crate) fn fixed(self) -> Window {
        match self {
            Self::Hann => Window::Hann,
            Self::Lanczos => Window::Lanczos,
            Self::None | Self::Nonnegative => Window::None,
        }
    }
}

impl WindowOn {
    pub(crate) fn is_on_light(self) -> bool {
        self != Self::Transfer
    }

    pub(crate) fn is_on_transfer(self) -> bool {
        self != Self::Light
    }
}
