//! Meshes brought to the size of built-in shapes, whatever unit their file has.

use super::{Mesh, bounds};

impl Mesh {
    /// The mesh shifted and scaled so that its longest side reaches from -1 to 1 about the origin; unchanged without a side.
    pub fn in_unit_size(mut self) -> Self {
        let Some((min, max)) = bounds(&self.positions) else { return self };
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        let (center, half) = (min.midpoint(max), 0.5 * (max - min).max_element());
        if half > 0.0 {
            self.positions.iter_mut().for_each(|p| *p = ((p.as_dvec3() - center) / half).as_vec3());
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::shapes;
    use glam::Vec3;

    #[test]
    fn the_longest_side_reaches_from_minus_one_to_one() {
        for (scale, place) in [(1e-3, Vec3::ZERO), (1.0, Vec3::new(5.0, -3.0, 1.0)), (1e11, Vec3::X)] {
            let mut mesh = shapes::cylinder(12);
            mesh.positions.iter_mut().for_each(|p| *p = scale * (*p * Vec3::new(1.0, 2.0, 0.5) + place));
            let (min, max) = mesh.in_unit_size().bounds().unwrap();
            assert!((min.y + 1.0).abs() < 1e-5 && (max.y - 1.0).abs() < 1e-5, "{scale}: {min} {max}");
            assert!((min + max).abs().max_element() < 1e-4 && (max.x - 0.5).abs() < 1e-4, "{scale}: {min} {max}");
        }
        assert_eq!(Mesh::default().in_unit_size(), Mesh::default());
    }
}
