// Σ log B over the spheres of a group [Guerrero2007, eq. 4.7]: twin of `sh_exp/kernel/log_sum.rs`.
#import "sh_exp/blocker.wgsl"

fn log_sum(position: vec3f, normal: vec3f, cut: Cut) -> Sh {
    var sum = Sh();
    for (var i = cut.first; i < cut.end; i++) {
        let blocker = blockers[i];
        let seen = seen_from(blocker, position, normal);
        if (seen.sin_squared > 0.0 && hides(blocker, cut)) {
            sum = sh_add_lobe(seen.direction, zonal_log(blocker, seen.sin_squared, 0u), sum);
        }
    }
    return sum;
}
