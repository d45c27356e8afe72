// Shadow rays of a frame, one receiver per invocation.
#import "common/receivers.wgsl"
#import "ray_traced/light.wgsl"
#import "ray_traced/random.wgsl"
#import "ray_traced/reflector.wgsl"
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

// Direction of a sample.
fn drawn_direction(
    receiver: Receiver,
    reflector: ptr<function, Reflector>,
    power: f32,
    shifts: Shifts,
    number: u32,
) -> vec3f {
    let share = frame.cosine_share;
    let is_glossy = IS_GLOSSY && (*reflector).count > 0u;
    if (share == 1.0 && !is_glossy) {
        let u = coordinate(shifts.x, frame.plane_steps.xy, number);
        return cosine_direction(receiver.normal, u, coordinate(shifts.y, frame.plane_steps.zw, number));
    }
    let choice = coordinate(shifts.x, frame.space_steps.xy, number);
    let u = coordinate(shifts.y, frame.space_steps.zw, number);
    let v = coordinate(shifts.z, frame.space_last_step, number);
    if (choice >= share) {
        return light_direction(receiver.position, receiver.normal, power, (choice - share) / (1.0 - share), u, v);
    } else if (is_glossy) {
        return reflected_direction(reflector, choice / share, u, v);
    } else {
        return cosine_direction(receiver.normal, u, v);
    }
}

// Sum over the samples of this dispatch: of a glossy receiver what it sends out, of another one what it would if it were
// white.
fn shaded(lane: u32, placed: Receiver, reflector: ptr<function, Reflector>) -> vec3f {
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
        let direction = drawn_direction(receiver, reflector, power, shifts, i);
        let cosine = dot(receiver.normal, direction);
        if (cosine <= 0.0) {
            continue;
        }
        var reflected = Reflected(vec3f(cosine / PI), cosine / PI);
        if (IS_GLOSSY && (*reflector).count > 0u) {
            reflected = reflected_along(reflector, receiver.normal, direction);
        }
        let arriving = arriving_radiance(receiver.position, direction);
        let density = share * reflected.density + (1.0 - share) * sum_of(arriving) / power;
        if (any(arriving != vec3f(0.0)) && density > 0.0) {
            sum += seen_radiance(lane, start, receiver, direction) * reflected.reflectance / density;
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
    if (number >= receiver_count()) {
        return;
    }
    let receiver = receiver_at(number);
    var reflector = Reflector();
    if (IS_GLOSSY) {
        reflector = reflector_of(number, receiver);
    }
    let mean = shaded(lane, receiver, &reflector) / f32(frame.samples);
    if (reflector.count > 0u) {
        add_radiance(number, mean, part.x == 0u);
    } else {
        accumulate(number, mean, part.x == 0u);
    }
}
