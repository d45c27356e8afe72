//! Tests of each method in a folder of its own, and of what holds across methods, as one program: linking is slow.

mod across_methods;
mod analytic;
mod built_scenes;
mod cached_fields;
mod common;
mod cosine_lobe;
mod mask;
mod prt;
mod ray_traced;
mod sh_exp;
mod shadow_field;
mod sphere_scenes;
