//! Residuals with their slopes, each of which knows few of many spheres.

/// Slopes with the four numbers of a sphere: its centre and radius.
pub(super) type PerSphere = [f64; 4];

/// Residuals r and the rows of their Jacobian J.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    residuals: Vec<f64>,
    /// Where the slopes of each row end.
    ends: Vec<usize>,
    slopes: Vec<(u32, PerSphere)>,
}

impl Rows {
    /// Adds `factor` times a residual and its slopes, of which those that are 0 are left out.
    pub(super) fn push(&mut self, factor: f64, residual: f64, slopes: impl Iterator<Item = (usize, PerSphere)>) {
        self.residuals.push(factor * residual);
        let some = slopes.filter(|(_, slope)| *slope != [0.0; 4]);
        self.slopes.extend(some.map(|(sphere, slope)| (sphere as u32, slope.map(|slope| factor * slope))));
        self.ends.push(self.slopes.len());
    }

    /// Adds the rows of `other` after these.
    pub(super) fn append(&mut self, other: Self) {
        let begin = self.slopes.len();
        self.residuals.extend(other.residuals);
        self.ends.extend(other.ends.iter().map(|end| begin + end));
        self.slopes.extend(other.slopes);
    }

    /// |r|².
    pub(super) fn cost(&self) -> f64 {
        self.residuals.iter().map(|r| r * r).sum()
    }

    /// −Jᵀr.
    pub(super) fn descent(&self, spheres: usize) -> Vec<PerSphere> {
        let mut sum = vec![[0.0; 4]; spheres];
        for (residual, slopes) in self.residuals.iter().zip(self.each()) {
            add_row(&mut sum, -residual, slopes);
        }
        sum
    }

    /// Diagonal of JᵀJ.
    pub(super) fn squares(&self, spheres: usize) -> Vec<PerSphere> {
        let mut sum = vec![[0.0; 4]; spheres];
        for (sphere, slope) in &self.slopes {
            sum[*sphere as usize].iter_mut().zip(slope).for_each(|(sum, slope)| *sum += slope * slope);
        }
        sum
    }

    /// JᵀJ x.
    pub(super) fn normal_product(&self, x: &[PerSphere]) -> Vec<PerSphere> {
        let mut sum = vec![[0.0; 4]; x.len()];
        for slopes in self.each() {
            let along = slopes.iter().map(|(sphere, slope)| dot(slope, &x[*sphere as usize])).sum();
            add_row(&mut sum, along, slopes);
        }
        sum
    }

    fn each(&self) -> impl Iterator<Item = &[(u32, PerSphere)]> {
        (0..self.ends.len()).map(|row| &self.slopes[row.checked_sub(1).map_or(0, |row| self.ends[row])..self.ends[row]])
    }
}

fn add_row(sum: &mut [PerSphere], factor: f64, slopes: &[(u32, PerSphere)]) {
    for (sphere, slope) in slopes {
        sum[*sphere as usize].iter_mut().zip(slope).for_each(|(sum, slope)| *sum += factor * slope);
    }
}

pub(super) fn dot(a: &PerSphere, b: &PerSphere) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
