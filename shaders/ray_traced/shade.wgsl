// Shadow rays of a frame, one receiver per invocation.
#import "common/receivers.wgsl"
#import "ray_traced/irradiance.wgsl"
#import "ray_traced/light.wgsl"
#import "ray_traced/product.wgsl"
#import "ray_traced/random.wgsl"
#import "ray_traced/reflector.wgsl"
#import "ray_traced/sequence.wgsl"
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

// Whether light that is known is multiplied by the share of it that rays see.
override IS_RATIO: bool = false;

// Means over samples.
struct Means {
    // Light that a glossy receiver sends out; that another one would if it were white.
    sent: vec3f,
    // Light that a white diffuse receiver would send out, and the same as if nothing were hidden.
    seen: vec3f,
    open: vec3f,
}

// Means over all samples to which those of this dispatch contribute.
fn means_of(lane: u32, receiver: Receiver, reflector: ptr<function, Reflector>) -> Means {
    var means = Means();
    let power = power_at(receiver.position);
    if (power <= 0.0) {
        return means;
    }
    let start = start_of(receiver);
    let shifts = shifts_of(receiver.group);
    let share = frame.cosine_share;
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
            let seen = seen_radiance(lane, start, receiver, direction);
            let weight = 1.0 / (density * f32(frame.samples));
            means.sent += seen * reflected.reflectance * weight;
            means.seen += seen * (cosine / PI * weight);
            means.open += arriving * (cosine / PI * weight);
        }
    }
    return means;
}

// The share that is seen, by channel; all of it where no sample carries light.
fn share_of(seen: vec3f, open: vec3f) -> vec3f {
    let share = seen / max(open, vec3f(SMALLEST));
    return min(select(vec3f(1.0), share, open > vec3f(0.0)), vec3f(1.0));
}

// Whether directions of diffuse receivers are drawn by light times cosine, light by light.
override IS_PRODUCT: bool = false;
// Whether shares are smoothed over neighbours afterwards.
override IS_FILTERED: bool = false;

// Slots of what is kept from dispatch to dispatch: light that is seen and as if nothing were hidden, by product of the light
// whose samples are being drawn; then the same of all lights.
const SEEN = 0u;
const OPEN = 1u;
const ALL_SEEN = 2u;
const ALL_OPEN = 3u;
// And of what is kept for a filter.
const SHARE = 0u;
const KNOWN = 3u;

// Adds a share of the light that is known to what a receiver sends out apart from it, or keeps both for the filter.
fn finish(number: u32, known: vec3f, share: vec3f) {
    if (IS_FILTERED) {
        keep(number, SHARE, share);
        keep(number, KNOWN, known);
    } else {
        accumulate(number, known * share, false);
    }
}

// Adds to the means that are kept, and at the last of the samples makes of them what a receiver sends out.
fn add_ratio(number: u32, receiver: Receiver, own: Means) {
    var means = own;
    if (part.x > 0u) {
        means.seen += kept(number, SEEN);
        means.open += kept(number, OPEN);
    }
    keep(number, SEEN, means.seen);
    keep(number, OPEN, means.open);
    add_radiance(number, own.sent, part.x == 0u);
    if (part.x + SAMPLES_AT_ONCE >= frame.samples) {
        // The diffuse part is in all of it by these very samples.
        accumulate(number, -means.seen, false);
        clamp_radiance(number);
        let known = irradiance_at(receiver.position, receiver.normal) / PI;
        finish(number, known, share_of(means.seen, means.open));
    }
}

// Means of one light and of all.
struct Products {
    seen: vec3f,
    open: vec3f,
    all_seen: vec3f,
    all_open: vec3f,
    // Irradiance by chances alone.
    plain: vec3f,
}

// Adds the share of a light whose samples have all been drawn.
fn add_part(products: ptr<function, Products>, irradiance: vec3f, relative_step: f32) {
    if (any((*products).open != vec3f(0.0))) {
        let open = irradiance * max(relative_step, 1.0);
        (*products).all_seen += open * share_of((*products).seen, (*products).open);
        (*products).all_open += open;
    }
    (*products).seen = vec3f(0.0);
    (*products).open = vec3f(0.0);
}

// Draws the samples of this dispatch, light by light. `total` is the irradiance of all, summed over the channels.
fn draw_products(
    lane: u32,
    receiver: Receiver,
    turned: vec3f,
    total: f32,
    products: ptr<function, Products>,
) {
    let start = start_of(receiver);
    let offset = sequence_offset(receiver.group);
    let step = total / f32(frame.samples);
    let stop = min(part.x + SAMPLES_AT_ONCE, frame.samples);
    var next = part.x;
    var first = 0u;
    var end = 0.0;
    for (var light = 0u; light < light_parts(); light++) {
        let irradiance = part_irradiance(light, receiver.position, receiver.normal, turned);
        let own = sum_of(irradiance);
        end += own;
        // Samples that lie before the end of this light, the first of which may have been drawn before.
        let last = clamp(u32(max(ceil(end / step - offset), 0.0)), first, frame.samples);
        let count = last - first;
        if (next >= last) {
            first = last;
            continue;
        }
        for (; next < min(stop, last); next++) {
            let point = sequence_point(receiver.group, count, next - first);
            let drawn = drawn_for(light, receiver.position, receiver.normal, turned, point);
            if (any(drawn.arriving != vec3f(0.0))) {
                (*products).open += drawn.arriving;
                if (is_seen(lane, start, receiver.normal, drawn.direction, drawn.distance)) {
                    (*products).seen += drawn.arriving;
                    (*products).plain += drawn.arriving * (step / own);
                }
            }
        }
        if (next < last) {
            // The next dispatch goes on with this light.
            break;
        }
        first = last;
        add_part(products, irradiance, step / own);
    }
}

fn add_product(lane: u32, number: u32, receiver: Receiver) {
    let turned = normalize(environment_from_world(receiver.normal));
    var total = 0.0;
    for (var light = 0u; light < light_parts(); light++) {
        total += sum_of(part_irradiance(light, receiver.position, receiver.normal, turned));
    }
    var products = Products();
    if (part.x > 0u) {
        products = Products(
            kept(number, SEEN), kept(number, OPEN), kept(number, ALL_SEEN), kept(number, ALL_OPEN), vec3f(0.0));
    }
    if (total > 0.0) {
        draw_products(lane, receiver, turned, total, &products);
    }
    keep(number, SEEN, products.seen);
    keep(number, OPEN, products.open);
    keep(number, ALL_SEEN, products.all_seen);
    keep(number, ALL_OPEN, products.all_open);
    let plain = select(products.plain / PI, vec3f(0.0), IS_RATIO);
    accumulate(number, plain, part.x == 0u);
    if (IS_RATIO && part.x + SAMPLES_AT_ONCE >= frame.samples) {
        let known = irradiance_at(receiver.position, receiver.normal) / PI;
        finish(number, known, share_of(products.all_seen, products.all_open));
    }
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
    var receiver = receiver_at(number);
    var reflector = Reflector();
    if (IS_GLOSSY) {
        reflector = reflector_of(number, receiver);
    }
    let size = length(receiver.normal);
    receiver.normal = select(vec3f(0.0, 1.0, 0.0), receiver.normal / size, size > 0.0);
    let is_glossy = reflector.count > 0u;
    if (IS_PRODUCT && !is_glossy) {
        add_product(lane, number, receiver);
        return;
    }
    var means = means_of(lane, receiver, &reflector);
    if (!is_glossy) {
        means.sent *= albedo_of(number);
    }
    if (IS_RATIO) {
        add_ratio(number, receiver, means);
    } else {
        add_radiance(number, means.sent, part.x == 0u);
    }
}
