//! Implicit bodies of statues: each stands on y = 0 and looks along +X.

use super::implicit::{Body, smooth_path};
use glam::{DQuat, Vec3};
use std::f64::consts::TAU;

/// A woman of marble, in a long dress, her hands folded over her belt.
pub(super) fn draped_woman() -> Body {
    let (marble, shade) = (Vec3::new(0.74, 0.71, 0.66), Vec3::new(0.58, 0.52, 0.45));
    let still = DQuat::IDENTITY;
    let tilt = DQuat::from_rotation_z;
    let arm = smooth_path(&[
        [-0.01, 1.235, 0.185, 0.062],
        [-0.05, 1.10, 0.245, 0.056],
        [-0.01, 0.97, 0.255, 0.052],
        [0.10, 0.945, 0.16, 0.044],
        [0.165, 0.95, 0.03, 0.042],
    ]);
    let mut body = Body::new(0.03)
        .ellipsoid([0.0, 0.03, 0.0], [0.37, 0.09, 0.37], still, 0.0, shade)
        .tube(&[[0.0, 0.16, 0.0, 0.25], [0.0, 0.45, 0.0, 0.195], [0.0, 0.92, 0.0, 0.115]], 0.05, marble)
        .ellipsoid([0.0, 0.86, 0.0], [0.135, 0.16, 0.165], still, 0.08, marble)
        .ellipsoid([0.0, 1.12, 0.0], [0.115, 0.20, 0.155], tilt(0.08), 0.1, marble)
        .ellipsoid_pair([0.085, 1.14, 0.062], [0.06, 0.062, 0.06], still, 0.04, marble)
        .ellipsoid([-0.01, 1.25, 0.0], [0.085, 0.062, 0.205], still, 0.07, marble)
        .tube(&[[-0.01, 1.28, 0.0, 0.058], [0.005, 1.42, 0.0, 0.053]], 0.05, marble)
        .ellipsoid([0.025, 1.53, 0.0], [0.098, 0.135, 0.090], tilt(-0.10), 0.03, marble)
        .tube(&[[0.105, 1.555, 0.0, 0.016], [0.128, 1.508, 0.0, 0.022]], 0.03, marble)
        .ellipsoid_pair([0.092, 1.572, 0.038], [0.030, 0.016, 0.036], still, 0.03, marble)
        .ellipsoid([0.098, 1.462, 0.0], [0.026, 0.016, 0.034], still, 0.03, marble)
        .ellipsoid([-0.025, 1.585, 0.0], [0.112, 0.112, 0.112], still, 0.03, shade)
        .ellipsoid_pair([-0.01, 1.50, 0.082], [0.065, 0.10, 0.042], still, 0.03, shade)
        .sphere([-0.145, 1.57, 0.0], 0.072, 0.03, shade)
        .tube_pair(&arm, 0.05, marble);
    // Folds fall from the belt and spread toward the hem.
    const FOLDS: usize = 11;
    for fold in 0..FOLDS {
        let at = |angle: f64, radius: f64, height: f64, thickness: f64| {
            let (sin, cos) = angle.sin_cos();
            [radius * cos, height, radius * sin, thickness]
        };
        let angle = TAU * (fold as f64 + 0.5) / FOLDS as f64;
        let path = smooth_path(&[
            at(angle, 0.105, 0.90, 0.020),
            at(angle + 0.06, 0.175, 0.55, 0.030),
            at(angle - 0.03, 0.235, 0.25, 0.038),
            at(angle + 0.03, 0.265, 0.09, 0.042),
        ]);
        body = body.tube(&path, 0.035, marble);
    }
    body.flat_base(0.0, 0.02)
}

/// A striding man of bronze, as thin as his shadow.
pub(super) fn walker() -> Body {
    let (bronze, green) = (Vec3::new(0.38, 0.22, 0.10), Vec3::new(0.22, 0.33, 0.25));
    let still = DQuat::IDENTITY;
    let front_leg = smooth_path(&[
        [0.02, 0.86, 0.055, 0.062],
        [0.13, 0.62, 0.06, 0.052],
        [0.17, 0.44, 0.06, 0.048],
        [0.21, 0.26, 0.06, 0.044],
        [0.24, 0.10, 0.06, 0.042],
    ]);
    let rear_leg = smooth_path(&[
        [-0.01, 0.86, -0.055, 0.062],
        [-0.05, 0.62, -0.06, 0.052],
        [-0.10, 0.44, -0.06, 0.048],
        [-0.21, 0.27, -0.06, 0.044],
        [-0.28, 0.12, -0.06, 0.042],
    ]);
    let front_arm = smooth_path(&[
        [0.03, 1.30, -0.13, 0.050],
        [0.09, 1.12, -0.205, 0.042],
        [0.15, 0.97, -0.21, 0.038],
        [0.26, 0.86, -0.19, 0.036],
    ]);
    let rear_arm = smooth_path(&[
        [0.03, 1.30, 0.13, 0.050],
        [-0.05, 1.13, 0.205, 0.042],
        [-0.09, 0.97, 0.215, 0.038],
        [-0.13, 0.80, 0.20, 0.036],
    ]);
    Body::new(0.05)
        .ellipsoid([-0.01, 0.01, 0.0], [0.48, 0.085, 0.21], still, 0.0, green)
        .tube(&front_leg, 0.065, bronze)
        .tube(&rear_leg, 0.065, bronze)
        .tube(&[[0.22, 0.08, 0.06, 0.045], [0.34, 0.07, 0.06, 0.036]], 0.065, green)
        .tube(&[[-0.29, 0.09, -0.06, 0.045], [-0.17, 0.075, -0.06, 0.036]], 0.065, green)
        .tube(&[[0.0, 0.86, 0.0, 0.070], [0.02, 1.08, 0.0, 0.072], [0.05, 1.26, 0.0, 0.088]], 0.065, bronze)
        .ellipsoid([0.04, 1.29, 0.0], [0.07, 0.065, 0.145], still, 0.065, bronze)
        .tube(&[[0.05, 1.32, 0.0, 0.045], [0.08, 1.46, 0.0, 0.040]], 0.065, bronze)
        .ellipsoid([0.10, 1.55, 0.0], [0.085, 0.12, 0.070], DQuat::from_rotation_z(-0.25), 0.065, bronze)
        .ellipsoid([0.182, 1.535, 0.0], [0.030, 0.03, 0.024], still, 0.065, bronze)
        .tube(&front_arm, 0.065, bronze)
        .tube(&rear_arm, 0.065, bronze)
        .flat_base(0.0, 0.02)
}

/// A head of basalt, with a hat of red tuff.
pub(super) fn stone_head() -> Body {
    let (basalt, tuff) = (Vec3::new(0.36, 0.35, 0.32), Vec3::new(0.52, 0.22, 0.13));
    let still = DQuat::IDENTITY;
    let tilt = DQuat::from_rotation_z;
    Body::new(0.02)
        .ellipsoid([0.0, 0.22, 0.0], [0.27, 0.52, 0.37], still, 0.0, basalt)
        .ellipsoid([0.02, 0.62, 0.0], [0.17, 0.22, 0.19], still, 0.12, basalt)
        .ellipsoid([0.02, 1.03, 0.0], [0.20, 0.44, 0.225], tilt(0.06), 0.06, basalt)
        .ellipsoid([0.155, 1.23, 0.0], [0.085, 0.045, 0.19], tilt(-0.1), 0.04, basalt)
        .tube(&[[0.19, 1.22, 0.0, 0.036], [0.255, 1.02, 0.0, 0.055]], 0.04, basalt)
        .ellipsoid_pair([0.225, 1.0, 0.045], [0.045, 0.035, 0.036], still, 0.035, basalt)
        .ellipsoid([0.205, 0.895, 0.0], [0.055, 0.024, 0.105], still, 0.035, basalt)
        .ellipsoid([0.195, 0.835, 0.0], [0.055, 0.026, 0.095], still, 0.035, basalt)
        .ellipsoid([0.165, 0.745, 0.0], [0.085, 0.065, 0.135], still, 0.05, basalt)
        .ellipsoid_pair([0.0, 1.06, 0.222], [0.055, 0.20, 0.032], still, 0.035, basalt)
        .ellipsoid([0.0, 1.53, 0.0], [0.205, 0.115, 0.215], still, 0.035, tuff)
        .sphere([0.0, 1.64, 0.0], 0.075, 0.04, tuff)
        .flat_base(0.0, 0.03)
}

/// A totem of painted cedar: a bear below, a raven with spread wings above.
pub(super) fn totem() -> Body {
    let cedar = Vec3::new(0.45, 0.25, 0.12);
    let (red, teal) = (Vec3::new(0.62, 0.08, 0.05), Vec3::new(0.07, 0.36, 0.36));
    let (white, black) = (Vec3::splat(0.86), Vec3::splat(0.03));
    let still = DQuat::IDENTITY;
    let tilt = DQuat::from_rotation_z;
    let wing = smooth_path(&[
        [-0.02, 1.28, 0.12, 0.085],
        [-0.03, 1.36, 0.28, 0.078],
        [-0.03, 1.38, 0.42, 0.066],
        [-0.03, 1.32, 0.54, 0.048],
    ]);
    let bear_arm = smooth_path(&[
        [0.02, 0.60, 0.21, 0.07],
        [0.10, 0.47, 0.235, 0.062],
        [0.20, 0.42, 0.16, 0.055],
        [0.24, 0.45, 0.06, 0.052],
    ]);
    Body::new(0.012)
        .ellipsoid([0.0, 0.03, 0.0], [0.32, 0.085, 0.32], still, 0.0, black)
        .tube(&[[0.0, 0.10, 0.0, 0.21], [0.0, 1.30, 0.0, 0.16]], 0.05, cedar)
        .ellipsoid([0.05, 0.32, 0.0], [0.20, 0.22, 0.215], still, 0.05, red)
        .tube_pair(&bear_arm, 0.05, black)
        .ellipsoid([0.04, 0.78, 0.0], [0.205, 0.18, 0.21], still, 0.05, cedar)
        .ellipsoid([0.22, 0.72, 0.0], [0.10, 0.065, 0.10], tilt(-0.1), 0.05, red)
        .sphere([0.315, 0.745, 0.0], 0.034, 0.03, black)
        .ellipsoid_pair([0.195, 0.84, 0.095], [0.048, 0.055, 0.062], still, 0.03, white)
        .ellipsoid_pair([0.228, 0.84, 0.102], [0.030, 0.032, 0.034], still, 0.03, black)
        .ellipsoid_pair([0.0, 0.95, 0.16], [0.045, 0.075, 0.065], still, 0.05, red)
        .ellipsoid([0.0, 1.14, 0.0], [0.19, 0.13, 0.195], still, 0.05, teal)
        .tube_pair(&wing, 0.05, black)
        .ellipsoid([0.02, 1.46, 0.0], [0.175, 0.165, 0.17], still, 0.05, teal)
        .tube(
            &smooth_path(&[[0.14, 1.47, 0.0, 0.075], [0.27, 1.44, 0.0, 0.058], [0.36, 1.36, 0.0, 0.034]]),
            0.02,
            black,
        )
        .ellipsoid_pair([0.13, 1.53, 0.095], [0.045, 0.05, 0.055], still, 0.03, white)
        .ellipsoid_pair([0.160, 1.535, 0.107], [0.028, 0.030, 0.030], still, 0.03, black)
        .ellipsoid([-0.02, 1.63, 0.0], [0.12, 0.06, 0.12], still, 0.05, red)
        .flat_base(0.0, 0.02)
}
