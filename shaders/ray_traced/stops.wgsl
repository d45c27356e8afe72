// Weights between neighbours: twin of `ray_traced/shade/filter.rs`.

// Where neighbours tell each other nothing; see there.
struct Stops {
    turn: f32,
    deviations_squared: f32,
    // Variance of a share of one half by so many rays, four times.
    variance: f32,
    // Stage of the filter: 0 finds variances, each one after it smooths over a level.
    stage: u32,
    is_last: u32,
    padding: u32,
    more_padding: u32,
    last_padding: u32,
}

// Rounding of shares, squared.
const LEAST_VARIANCE = 1e-8f;

fn mean_of(share: vec3f) -> f32 {
    return (share.x + share.y + share.z) * (1.0 / 3.0);
}

// Weight by surface of two receivers that lie `offset` apart.
fn along_surface(turn: f32, offset: vec3f, normal: vec3f, other: vec3f) -> f32 {
    let off = max(abs(dot(offset, normal)), abs(dot(offset, other)));
    let square = dot(offset, offset);
    var lifted = 0.0;
    if (off > 0.0 && square > 0.0) {
        lifted = 2.0 * (off * off / square);
    }
    let turned = 1.0 - dot(normal, other);
    let near = max(1.0 - max(turned, lifted) / turn, 0.0);
    return near * near;
}

// Weight by shares whose variances add up to `variance`.
fn along_shares(deviations_squared: f32, share: vec3f, other: vec3f, variance: f32) -> f32 {
    let apart = mean_of(share) - mean_of(other);
    let near = max(1.0 - apart * apart / (deviations_squared * variance + LEAST_VARIANCE), 0.0);
    return near * near;
}
