//! Effects: what a scene requires and a strategy can model.

use halfshade_scene::{
    Scene,
    light::{DistantLight, is_grey},
};
use std::fmt;

/// One thing light does, or a scene does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Effect {
    /// Light from infinitely far.
    EnvironmentLight,
    /// Light from spheres within the scene.
    LocalLights,
    /// Light that is not grey.
    ColouredLight,
    /// Surfaces that reflect more into some directions than into others.
    GlossyReflectance,
    /// Light that passes below a surface and leaves it elsewhere.
    SubsurfaceScattering,
    /// Light that surfaces reflect onto each other.
    Interreflection,
    /// Poses that change between frames.
    Motion,
    /// Meshes that change their shape between frames.
    Deformation,
}

impl Effect {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::EnvironmentLight,
        Self::LocalLights,
        Self::ColouredLight,
        Self::GlossyReflectance,
        Self::SubsurfaceScattering,
        Self::Interreflection,
        Self::Motion,
        Self::Deformation,
    ];

    /// All that direct light does at diffuse surfaces.
    pub const DIRECT: [Self; 5] =
        [Self::EnvironmentLight, Self::LocalLights, Self::ColouredLight, Self::Motion, Self::Deformation];

    /// As users read it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::EnvironmentLight => "environment light",
            Self::LocalLights => "local lights",
            Self::ColouredLight => "coloured light",
            Self::GlossyReflectance => "glossy reflectance",
            Self::SubsurfaceScattering => "subsurface scattering",
            Self::Interreflection => "interreflection",
            Self::Motion => "motion",
            Self::Deformation => "deformation",
        }
    }
}

/// A set of effects.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Effects(u32);

impl Effects {
    /// The set of `effects`.
    pub const fn of(effects: &[Effect]) -> Self {
        let mut bits = 0;
        let mut i = 0;
        while i < effects.len() {
            bits |= 1 << effects[i] as u32;
            i += 1;
        }
        Self(bits)
    }

    /// The set and `effect`.
    pub const fn with(self, effect: Effect) -> Self {
        Self(self.0 | 1 << effect as u32)
    }

    /// Whether `effect` is in the set.
    pub const fn contains(self, effect: Effect) -> bool {
        self.0 & (1 << effect as u32) != 0
    }

    /// The effects in the set.
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().filter(move |&effect| self.contains(effect))
    }

    /// The effects of `required` that `self` lacks.
    pub const fn missing(self, required: Self) -> Self {
        Self(required.0 & !self.0)
    }

    /// Whether there is nothing in the set.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The effects that `scene` requires and no more, so that nobody pays for what isn't there.
    pub fn required_by(scene: &Scene) -> Self {
        let mut effects = Vec::new();
        let (dark, base_grey) = match &scene.environment.base {
            DistantLight::Constant(c) => (*c == glam::Vec3::ZERO, is_grey(*c)),
            DistantLight::Map(map) => {
                (map.texels().iter().all(|t| *t == glam::Vec3::ZERO), map.texels().iter().all(|t| is_grey(*t)))
            }
        };
        if !dark || scene.environment.sun.is_some() {
            effects.push(Effect::EnvironmentLight);
        }
        if !scene.lights.is_empty() {
            effects.push(Effect::LocalLights);
        }
        let lights_grey = scene.lights.iter().all(|(light, _)| is_grey(light.radiance));
        if !(base_grey && lights_grey && scene.environment.sun.is_none_or(|sun| is_grey(sun.radiance))) {
            effects.push(Effect::ColouredLight);
        }
        if scene.is_glossy() {
            effects.push(Effect::GlossyReflectance);
        }
        if scene.is_translucent() {
            effects.push(Effect::SubsurfaceScattering);
        }
        if scene.bounces > 0 {
            effects.push(Effect::Interreflection);
        }
        if scene.objects.iter().any(|object| object.motion.moves())
            || scene.lights.iter().any(|(_, motion)| motion.moves())
            || scene.environment_turn_per_sec != 0.0
        {
            effects.push(Effect::Motion);
        }
        if scene.objects.iter().any(|object| object.skin.as_ref().is_some_and(|skin| skin.moves())) {
            effects.push(Effect::Deformation);
        }
        Self::of(&effects)
    }
}

impl fmt::Display for Effects {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, effect) in self.iter().enumerate() {
            write!(f, "{}{}", if i == 0 { "" } else { ", " }, effect.name())?;
        }
        Ok(())
    }
}
