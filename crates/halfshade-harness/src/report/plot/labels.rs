//! Places for labels beside points, so that none lies on another or on a mark.

/// A rectangle of pixels, its ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rect {
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
}

impl Rect {
    /// A square of half the side `reach` about a point.
    pub(super) fn about((x, y): (i32, i32), reach: i32) -> Self {
        Self { left: x - reach, top: y - reach, right: x + reach, bottom: y + reach }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.left <= other.right && other.left <= self.right && self.top <= other.bottom && other.top <= self.bottom
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left && other.right <= self.right && self.top <= other.top && other.bottom <= self.bottom
    }
}

/// A point, and the label that belongs to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Labelled {
    pub(super) point: (i32, i32),
    /// Width and height of the label; nothing if there is none.
    pub(super) size: (i32, i32),
}

/// Distances between a mark's edge and its label that are tried, as multiples of the mark's reach.
const DISTANCES: [f64; 8] = [0.4, 1.0, 2.0, 3.5, 5.0, 7.0, 9.0, 12.0];

/// Directions that are tried, the first the best: to the upper right, then around.
const DIRECTIONS: u32 = 16;

/// A place for a label of each size beside its point, within `bounds`; `None` where there is no room. Every point has a mark that reaches
/// `reach` pixels. Points amid many others choose first.
pub(super) fn place(points: &[Labelled], reach: i32, bounds: Rect) -> Vec<Option<Rect>> {
    let marks: Vec<Rect> = points.iter().map(|it| Rect::about(it.point, reach)).collect();
    let near = |&place: &usize| {
        let around = Rect::about(points[place].point, 8 * reach);
        std::cmp::Reverse(marks.iter().filter(|mark| mark.overlaps(&around)).count())
    };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(near);
    let mut placed: Vec<Option<Rect>> = vec![None; points.len()];
    for place in order {
        let Labelled { point: (x, y), size: (width, height) } = points[place];
        if width == 0 {
            continue;
        }
        let candidates = DISTANCES.iter().flat_map(|distance| {
            (0..DIRECTIONS).map(move |turn| {
                // Alternately to the left and to the right of the first.
                let step = f64::from(turn.div_ceil(2)) * if turn % 2 == 1 { 1.0 } else { -1.0 };
                let angle = -std::f64::consts::FRAC_PI_4 + step * std::f64::consts::TAU / f64::from(DIRECTIONS);
                let (sin, cos) = angle.sin_cos();
                let away = f64::from(reach) * (1.0 + distance);
                // The label's nearest edge or corner lies at that distance.
                let center_x = f64::from(x) + cos * away + 0.5 * f64::from(width) * cos.signum() * cos.abs().sqrt();
                let center_y = f64::from(y) + sin * away + 0.5 * f64::from(height) * sin.signum() * sin.abs().sqrt();
                let (left, top) =
                    ((center_x - 0.5 * f64::from(width)) as i32, (center_y - 0.5 * f64::from(height)) as i32);
                Rect { left, top, right: left + width, bottom: top + height }
            })
        });
        let is_free = |rect: &Rect| {
            bounds.holds(rect)
                && !marks.iter().any(|mark| mark.overlaps(rect))
                && !placed.iter().flatten().any(|other| other.overlaps(rect))
        };
        placed[place] = candidates.into_iter().find(is_free);
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_find_room_apart_from_each_other_and_from_marks() {
        let bounds = Rect { left: 0, top: 0, right: 700, bottom: 500 };
        // A crowd of points, some in one place, some at the edge.
        let labelled = |point, size| Labelled { point, size };
        let points: Vec<Labelled> = (0..60)
            .map(|i| labelled(((i * 37) % 300 + 400, (i * 53) % 250), (20 + i % 15, 14)))
            .chain([labelled((0, 500), (30, 14)), labelled((300, 300), (0, 0))])
            .collect();
        let placed = place(&points, 7, bounds);
        let found: Vec<&Rect> = placed.iter().flatten().collect();
        assert!(found.len() >= 55 && placed[61].is_none() && placed[60].is_some(), "{}", found.len());
        for (i, label) in found.iter().enumerate() {
            assert!(bounds.holds(label));
            assert!(!found[..i].iter().any(|other| other.overlaps(label)));
            assert!(!points.iter().any(|it| Rect::about(it.point, 7).overlaps(label)));
        }
        // Alone a label lies to the upper right.
        let alone = place(&[labelled((100, 100), (20, 14))], 7, bounds)[0].unwrap();
        assert!(alone.left > 100 && alone.bottom < 100, "{alone:?}");
    }
}
