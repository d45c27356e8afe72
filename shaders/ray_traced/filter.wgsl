// Shares of the light, smoothed over neighbours, one receiver per invocation and stage.
#import "common/receivers.wgsl"
#import "ray_traced/stops.wgsl"

// In storage: numbers of a uniform that decide branches Mesa's driver in software compiles into the kernel, with every dispatch.
@group(1) @binding(0) var<storage, read> stops: Stops;
// Eight numbers of receivers for each, those of one level.
@group(1) @binding(1) var<storage, read> neighbours: array<vec4u>;

const NOBODY = 0xffffffffu;

// Slots of what is kept of a receiver: shares before a stage and after it in turn, the variances of both, light that is known.
const VARIANCES = 2u;
const KNOWN = 3u;

fn variance_place(number: u32, source: u32) -> u32 {
    return (3u * (VARIANCES + 1u) + source) * receiver_count() + number;
}

// The neighbour at a place of the list.
fn neighbour_of(number: u32, k: u32) -> u32 {
    return neighbours[2u * number + k / 4u][k % 4u];
}

// Variance of a share by the mean around it.
fn find_variance(number: u32, own: Receiver) {
    var sum = mean_of(kept(number, 0u));
    var weights = 1.0;
    for (var k = 0u; k < 8u; k++) {
        let number_there = neighbour_of(number, k);
        if (number_there != NOBODY) {
            let other = receiver_at(number_there);
            let weight = select(0.25, 0.5, k < 4u)
                * along_surface(stops.turn, other.position - own.position, own.normal, other.normal);
            sum += weight * mean_of(kept(number_there, 0u));
            weights += weight;
        }
    }
    let mean = sum / weights;
    radiances[variance_place(number, 0u)] = max(mean * (1.0 - mean), 0.0) * stops.variance;
}

fn smooth_over_level(number: u32, own: Receiver) {
    let source = (stops.stage - 1u) % 2u;
    let share = kept(number, source);
    let variance = radiances[variance_place(number, source)];
    var sum = share;
    var variances = variance;
    var weights = 1.0;
    for (var k = 0u; k < 8u; k++) {
        let number_there = neighbour_of(number, k);
        if (number_there != NOBODY) {
            let other = receiver_at(number_there);
            let share_there = kept(number_there, source);
            let variance_there = radiances[variance_place(number_there, source)];
            let weight = select(0.25, 0.5, k < 4u)
                * along_surface(stops.turn, other.position - own.position, own.normal, other.normal)
                * along_shares(stops.deviations_squared, share, share_there, variance + variance_there);
            sum += weight * share_there;
            variances += weight * weight * variance_there;
            weights += weight;
        }
    }
    if (stops.is_last == 1u) {
        accumulate(number, kept(number, KNOWN) * (sum / weights), false);
    } else {
        keep(number, 1u - source, sum / weights);
        radiances[variance_place(number, 1u - source)] = variances / (weights * weights);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number >= receiver_count()) {
        return;
    }
    let own = receiver_at(number);
    if (stops.stage == 0u) {
        find_variance(number, own);
    } else {
        smooth_over_level(number, own);
    }
}
