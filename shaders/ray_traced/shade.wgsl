// Shadow rays of a frame, one receiver per invocation.
#import "common/receivers.wgsl"
#import "ray_traced/light.wgsl"
#import "ray_traced/random.wgsl"
#import "ray_traced/traverse.wgsl"

// Where rays of a receiver start.
struct Start {
    origin: vec3f,
    slack: vec3f,
    // Product of the slack and the normal, by axis.
    off: f32,
}

fn start_of(receiver: Receiver) -> Start {
    let slack = 4.0 * EPSILON * abs(receiver.position) + vec3f(1e-7f);
    let off = dot(abs(receiver.normal), slack);
    return Start(receiver.position + 2.0 * off * receiver.normal, slack, off);
}

fn is_seen(lane: u32, start: Start, normal: vec3f, direction: vec3f, limit: f32) -> bool {
    let largest = max(start.slack.x, max(start.slack.y, start.slack.z));
    let reach = min(4.0 * largest, start.off / max(dot(direction, normal), 1e-30f));
    return !is_blocked(lane, start.origin, direction, start.slack, reach, limit);
}

// The radiance that arrives along a direction and isn't blocked.
fn seen_radiance(lane: u32, start: Start, receiver: Receiver, direction: vec3f) -> vec3f {
    var radiance = distant_radiance(direction);
    if (any(radiance != vec3f(0.0)) && !is_seen(lane, start, receiver.normal, direction, 1e30f)) {
        radiance = vec3f(0.0);
    }
    for (var i = 0u; i < frame.light_count; i++) {
        let light = light_at(i);
        if (contains(cap_of(light, receiver.position), direction)) {
            let distance = distance_to(light, receiver.position, direction);
            if (is_seen(lane, start, receiver.normal, direction, distance)) {
                radiance += light.radiance;
            }
        }
    }
    return radiance;
}

// The first sample of a dispatch. One of all samples would keep a device busy for too long, and software drivers end loops of
// more than 65,535 rounds.
@group(2) @binding(0) var<uniform> part: vec4u;

override SAMPLES_AT_ONCE: u32 = 64u;

// Sum over the samples of this dispatch.
fn shaded(lane: u32, placed: Receiver) -> vec3f {
    var receiver = placed;
    let size = length(placed.normal);
    receiver.normal = select(vec3f(0.0, 1.0, 0.0), placed.normal / size, size > 0.0);
    let power = power_at(receiver.position);
    if (power <= 0.0) {
        return vec3f(0.0);
    }
    let start = start_of(receiver);
    let shifts = shifts_of(receiver.group);
    let share = frame.cosine_share;
    var sum = vec3f(0.0);
    let end = min(part.x + SAMPLES_AT_ONCE, frame.samples);
    for (var i = part.x; i < end; i++) {
        var direction = vec3f(0.0);
        if (share == 1.0) {
            let u = coordinate(shifts.x, frame.plane_steps.xy, i);
            direction = cosine_direction(receiver.normal, u, coordinate(shifts.y, frame.plane_steps.zw, i));
        } else {
            let choice = coordinate(shifts.x, frame.space_steps.xy, i);
            let u = coordinate(shifts.y, frame.space_steps.zw, i);
            let v = coordinate(shifts.z, frame.space_last_step, i);
            if (choice < share) {
                direction = cosine_direction(receiver.normal, u, v);
            } else {
                let rest = (choice - share) / (1.0 - share);
                direction = light_direction(receiver.position, receiver.normal, power, rest, u, v);
            }
        }
        let cosine = dot(receiver.normal, direction);
        if (cosine <= 0.0) {
            continue;
        }
        let arriving = arriving_radiance(receiver.position, direction);
        let density = share * cosine / PI + (1.0 - share) * sum_of(arriving) / power;
        if (any(arriving != vec3f(0.0)) && density > 0.0) {
            sum += seen_radiance(lane, start, receiver, direction) * (cosine / (PI * density));
        }
    }
    return sum;
}

@compute @workgroup_size(64)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let number = invocation.x;
    if (number < receiver_count()) {
        accumulate(number, shaded(lane, receiver_at(number)) / f32(frame.samples), part.x == 0u);
    }
}
