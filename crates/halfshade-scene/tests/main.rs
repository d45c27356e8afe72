//! Tests of every format that is read, as one program: linking is slow.

mod bad_input;
mod damaged_meshes;
mod exchange;
mod gltf;
mod mesh_files;
mod picture_files;
mod probe_files;
mod real_input;
mod sphere_errors;
mod sphere_fits;
