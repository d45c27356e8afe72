//! WGSL files of `shaders/`, put together: `#import "path"` stands for a file, once however often it is asked for.

use std::collections::BTreeSet;

macro_rules! sources {
    ($($path:literal)*) => {
        /// Every file of `shaders/`, by its path there.
        pub(crate) const SOURCES: &[(&str, &str)] = &[
            $(($path, include_str!(concat!("../../../shaders/", $path)))),*
        ];
    };
}

sources! {
    "analytic/frame.wgsl"
    "analytic/overlap.wgsl"
    "analytic/shade.wgsl"
    "common/cap.wgsl"
    "common/constants.wgsl"
    "common/eye_lobes.wgsl"
    "common/near_zero.wgsl"
    "common/octahedral.wgsl"
    "common/receivers.wgsl"
    "common/reflectance.wgsl"
    "mask/boxes.wgsl"
    "mask/bundle.wgsl"
    "mask/cap.wgsl"
    "mask/directions.wgsl"
    "mask/four.wgsl"
    "mask/frame.wgsl"
    "mask/lamp.wgsl"
    "mask/lobe.wgsl"
    "mask/lobe_light.wgsl"
    "mask/own.wgsl"
    "mask/shade.wgsl"
    "prt/decode.wgsl"
    "prt/dot.wgsl"
    "prt/gloss.wgsl"
    "prt/lamps.wgsl"
    "prt/lobe.wgsl"
    "prt/shade.wgsl"
    "prt/shade_clusters.wgsl"
    "prt/shade_lamps.wgsl"
    "ray_traced/cutout.wgsl"
    "ray_traced/filter.wgsl"
    "ray_traced/frame.wgsl"
    "ray_traced/irradiance.wgsl"
    "ray_traced/light.wgsl"
    "ray_traced/light_tree.wgsl"
    "ray_traced/product.wgsl"
    "ray_traced/random.wgsl"
    "ray_traced/reflector.wgsl"
    "ray_traced/sequence.wgsl"
    "ray_traced/shade.wgsl"
    "ray_traced/stops.wgsl"
    "ray_traced/traverse.wgsl"
    "sh_exp/blocker.wgsl"
    "sh_exp/emit.wgsl"
    "sh_exp/exponential.wgsl"
    "sh_exp/frame.wgsl"
    "sh_exp/gather.wgsl"
    "sh_exp/ground.wgsl"
    "sh_exp/lamps.wgsl"
    "sh_exp/light.wgsl"
    "sh_exp/log_sum.wgsl"
    "sh_exp/own.wgsl"
    "sh_exp/product.wgsl"
    "sh_exp/shade.wgsl"
    "sh_exp/shares.wgsl"
    "shadow_field/bounded_product.wgsl"
    "shadow_field/frame.wgsl"
    "shadow_field/gloss.wgsl"
    "shadow_field/light_order.wgsl"
    "shadow_field/light_product.wgsl"
    "shadow_field/occlusion.wgsl"
    "shadow_field/reconstruct.wgsl"
    "shadow_field/rotate.wgsl"
    "shadow_field/shade.wgsl"
    "shadow_field/shell_coordinates.wgsl"
    "shadow_field/shell_grid.wgsl"
    "shared/cosine_power.wgsl"
    "shared/irradiance.wgsl"
    "shared/light_cap.wgsl"
    "shared/placed_lamps.wgsl"
    "shared/tangent_plane.wgsl"
    "unshadowed/shade.wgsl"
}

/// The text of a file.
pub(crate) fn source(path: &str) -> Option<&'static str> {
    SOURCES.iter().find(|(known, _)| *known == path).map(|(_, text)| *text)
}

/// The import that stands for what turns vectors of the module's number of bands.
const ROTATION: &str = "sh/rotation";

/// A whole module: the kernels of so many bands if it needs any, then the file at `path` after all that it imports. An import
/// of a file that there isn't, is left as it stands, for the WGSL parser to refuse.
pub(crate) fn module(path: &str, bands: Option<usize>) -> String {
    let mut code = bands.and_then(halfshade_sh::wgsl::kernels).unwrap_or_default().to_owned();
    include(path, bands, &mut BTreeSet::new(), &mut code);
    code
}

fn include<'a>(path: &'a str, bands: Option<usize>, included: &mut BTreeSet<&'a str>, code: &mut String) {
    let text = |path: &str| match path {
        ROTATION => bands.and_then(halfshade_sh::wgsl::rotation),
        _ => source(path),
    };
    let Some(own) = text(path).filter(|_| included.insert(path)) else { return };
    let imported = |line: &'static str| line.strip_prefix("#import \"")?.strip_suffix('"');
    let imports = own.lines().filter_map(imported);
    for path in imports.clone() {
        include(path, bands, included, code);
    }
    for line in own.lines() {
        if imported(line).is_none_or(|path| text(path).is_none()) {
            code.push_str(line);
            code.push('\n');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files in the folder are those that are built in.
    #[test]
    fn every_file_is_listed() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
        let mut found = Vec::new();
        for folder in std::fs::read_dir(&root).unwrap().map(|entry| entry.unwrap()) {
            for file in std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap()) {
                let [folder, file] = [folder.file_name(), file.file_name()].map(|name| name.into_string().unwrap());
                found.push(format!("{folder}/{file}"));
            }
        }
        found.sort();
        assert_eq!(found, SOURCES.iter().map(|(path, _)| *path).collect::<Vec<_>>());
    }

    #[test]
    fn a_file_is_imported_once_and_before_it_is_used() {
        let code = module("sh_exp/shade.wgsl", Some(4));
        assert_eq!(code.matches("struct Blocker").count(), 1);
        assert!(code.find("fn seen_from").unwrap() < code.find("fn log_sum").unwrap());
        assert!(!code.contains("#import"));
    }
}
