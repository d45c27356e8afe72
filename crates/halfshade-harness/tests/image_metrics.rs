//! Similarity of pictures: an integration test, since with the feature `flip` it is all that has to be compiled anew.

use glam::Vec3;
use halfshade_harness::{image_io::Picture, image_metrics::Similarity};

#[test]
fn identical_pictures_are_the_most_alike() {
    let truth = Picture {
        width: 32,
        height: 32,
        pixels: (0..1024).map(|i| Vec3::splat(if (i / 4 + i / 128) % 2 == 0 { 0.8 } else { 0.1 })).collect(),
    };
    let disturbed = |amount: f32| {
        let mut picture = truth.clone();
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            *pixel += amount * ((i * 7919 % 13) as f32 / 13.0 - 0.5);
        }
        Similarity::between(&picture, &truth, 1.0)
    };
    let (same, map) = Similarity::between(&truth, &truth, 1.0);
    let ((little, _), (much, much_map)) = (disturbed(0.05), disturbed(0.5));
    let ssim = [same, little, much].map(|similarity| similarity.ssim.unwrap());
    assert!((ssim[0] - 1.0).abs() < 1e-9 && 1.0 > ssim[1] && ssim[1] > ssim[2] && ssim[2] > 0.0, "{ssim:?}");
    let flip = [same, little, much].map(|similarity| similarity.flip);
    if cfg!(feature = "flip") {
        let flip = flip.map(Option::unwrap);
        assert!(flip[0] == 0.0 && 0.0 < flip[1] && flip[1] < flip[2] && flip[2] <= 1.0, "{flip:?}");
        // The map is as large, all black where nothing differs, and brighter where much does.
        let [map, much_map] = [map, much_map].map(Option::unwrap);
        assert_eq!(map.dimensions(), (32, 32));
        assert!(map.pixels().all(|pixel| pixel.0 == map.get_pixel(0, 0).0 && pixel.0.iter().all(|value| *value < 8)));
        assert!(much_map.pixels().any(|pixel| pixel.0.iter().any(|value| *value > 100)));
    } else {
        assert_eq!(flip, [None; 3]);
        assert!(map.is_none());
    }
    let other_size = Similarity::between(&truth, &Picture::filled(3, 3, Vec3::ONE), 1.0);
    assert!(other_size == (Similarity::default(), None));
}
