// Directions that blockers close, one receiver per invocation: twin of `mask/shade/batch.rs`.
#import "common/octahedral.wgsl"
#import "common/receivers.wgsl"
#import "mask/boxes.wgsl"
#import "mask/cap.wgsl"
#import "mask/directions.wgsl"
#import "mask/frame.wgsl"
#import "mask/lamp.wgsl"
#import "mask/own.wgsl"
#import "shared/placed_lamps.wgsl"

// Sixteen directions, or what is open of them.
struct Sixteen {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    d: vec4f,
}

struct Sums {
    seen: vec3f,
    all: vec3f,
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let number = invocation.x;
    if (number >= receiver_count()) {
        return;
    }
    let receiver = receiver_at(number);
    let own = own_point(receiver.group);
    let whole = rest_irradiance(receiver.normal);
    var irradiance = vec3f(0.0);
    if (any(whole != vec3f(0.0))) {
        irradiance = whole * seen_share(receiver, own);
    }
    for (var lamp = 0u; lamp < frame.lamp_count; lamp++) {
        irradiance += light_of_lamp(frame.lamps + 2u * lamp, receiver, own);
    }
    reflect(number, irradiance / PI);
}

// The row of the directions of receivers with a normal.
fn set_of(normal: vec3f) -> u32 {
    let rows_of_set = 1u + 28u * frame.set_sixteens;
    if (frame.normal_cells == 0.0) {
        return frame.sets;
    }
    let found = octahedral_lookup(normal, frame.normal_cells);
    var best = 0u;
    if (found.weights.y > found.weights.x + PREFERENCE) {
        best = 1u;
    }
    if (found.weights.z > found.weights[best] + PREFERENCE) {
        best = 2u;
    }
    return frame.sets + rows_of_set * found.nodes[best];
}

// By how much a later node is to be nearer: normals half-way between nodes are frequent.
const PREFERENCE = 1e-3f;

fn four_at(row: u32) -> Four {
    return Four(tables[row], tables[row + 1u], tables[row + 2u]);
}

// The part of four directions that neither the receiver's own object nor a box hides.
fn open_of(receiver: Receiver, own: OwnPoint, four: Four) -> vec4f {
    return own_open(own, receiver.object, four) * open_beside_boxes(receiver, four, 3e38f);
}

fn open_beside_boxes(receiver: Receiver, four: Four, limit: f32) -> vec4f {
    var open = vec4f(1.0);
    for (var number = 0u; number < frame.box_count; number++) {
        let first = frame.boxes + 5u * number;
        if (u32(rows[first].w) != receiver.object) {
            open *= open_beside_box(first, receiver.position, four, limit);
        }
    }
    return open;
}

// Whether a receiver sees the sphere of this number: its own object's are left out where its mesh is known.
fn sees(number: u32, receiver: Receiver, own: OwnPoint) -> bool {
    return !(own.is_known && u32(rows[2u * number + 1u].x) == receiver.object);
}

fn cap_at(number: u32, receiver: Receiver) -> Cap {
    let sphere = rows[2u * number];
    return cap_of(sphere.xyz - receiver.position, sphere.w, receiver.normal);
}

fn add(sums: Sums, row: u32, open: vec4f, four: Four, normal: vec3f) -> Sums {
    let cosine = max(along(four, normal), vec4f(0.0));
    var added = sums;
    for (var channel = 0u; channel < 3u; channel++) {
        let all = cosine * tables[row + 4u + channel];
        added.all[channel] += all.x + all.y + all.z + all.w;
        added.seen[channel] += dot(all, open);
    }
    return added;
}

// The share that is seen by channel; 1 where no direction carries light.
fn shares(sums: Sums) -> vec3f {
    let share = min(sums.seen / max(sums.all, vec3f(SMALLEST)), vec3f(1.0));
    return select(vec3f(1.0), share, sums.all > vec3f(0.0));
}

fn seen_share(receiver: Receiver, own: OwnPoint) -> vec3f {
    let chosen = set_of(receiver.normal);
    let mean_sharpness = tables[chosen].x;
    var sums = Sums(vec3f(0.0), vec3f(0.0));
    for (var sixteen = 0u; sixteen < frame.set_sixteens; sixteen++) {
        let row = chosen + 1u + 28u * sixteen;
        let a = four_at(row);
        let b = four_at(row + 7u);
        let c = four_at(row + 14u);
        let d = four_at(row + 21u);
        let sharpness = Sixteen(tables[row + 3u], tables[row + 10u], tables[row + 17u], tables[row + 24u]);
        var open = Sixteen(
            open_of(receiver, own, a), open_of(receiver, own, b), open_of(receiver, own, c), open_of(receiver, own, d));
        for (var number = 0u; number < frame.sphere_count; number++) {
            if (!sees(number, receiver, own)) {
                continue;
            }
            let cap = cap_at(number, receiver);
            if (cap.cotangent >= NOTHING) {
                continue;
            }
            let rest = 1.0 - edge_offset(cap.half_tangent, mean_sharpness);
            open.a = closed(open.a, a, sharpness.a, cap, rest);
            open.b = closed(open.b, b, sharpness.b, cap, rest);
            open.c = closed(open.c, c, sharpness.c, cap, rest);
            open.d = closed(open.d, d, sharpness.d, cap, rest);
        }
        sums = add(sums, row, open.a, a, receiver.normal);
        sums = add(sums, row + 7u, open.b, b, receiver.normal);
        sums = add(sums, row + 14u, open.c, c, receiver.normal);
        sums = add(sums, row + 21u, open.d, d, receiver.normal);
    }
    return shares(sums);
}

// 1 less the cosine of the angular radius of a cell of what meshes hide from themselves.
fn cell_versine() -> f32 {
    if (frame.own_side == 0u) {
        return 0.0;
    }
    return 2.0 / f32(frame.own_side * frame.own_side);
}

fn shift_of(view: LampView, row: u32) -> Four {
    return spread(view.versine, tables[row], tables[row + 1u], tables[row + 2u]);
}

// The part of four directions into a lamp that is open before any sphere.
fn open_before(view: LampView, row: u32, limit: f32, receiver: Receiver, own: OwnPoint) -> vec4f {
    let over_cell = spread(max(view.versine, cell_versine()), tables[row], tables[row + 1u], tables[row + 2u]);
    let open = own_open(own, receiver.object, moved(in_light_space(view, over_cell), view.axis));
    let four = moved(in_light_space(view, shift_of(view, row)), view.axis);
    return open * open_beside_boxes(receiver, four, limit);
}

fn light_of_lamp(first: u32, receiver: Receiver, own: OwnPoint) -> vec3f {
    let place = rows[first];
    let is_near = rows[first + 1u].w > 0.5;
    let whole = rows[first + 1u].xyz * lamp_form(place, is_near, receiver.position, receiver.normal);
    if (all(whole == vec3f(0.0))) {
        return whole;
    }
    let view = lamp_view(place, is_near, receiver.position, receiver.normal);
    let limit = select(3e38f, view.distance, is_near);
    var seen = 0.0;
    var all_of_it = 0.0;
    for (var sixteen = 0u; sixteen < frame.lamp_sixteens; sixteen++) {
        let row = frame.spiral + 12u * sixteen;
        var open = Sixteen(
            open_before(view, row, limit, receiver, own), open_before(view, row + 3u, limit, receiver, own),
            open_before(view, row + 6u, limit, receiver, own), open_before(view, row + 9u, limit, receiver, own));
        let a = shift_of(view, row);
        let b = shift_of(view, row + 3u);
        let c = shift_of(view, row + 6u);
        let d = shift_of(view, row + 9u);
        for (var number = 0u; number < frame.sphere_count; number++) {
            if (!sees(number, receiver, own)) {
                continue;
            }
            let cap = lamp_cap(view, cap_at(number, receiver));
            if (!cap.may_hide) {
                continue;
            }
            open.a = closed_before(open.a, a, view, cap);
            open.b = closed_before(open.b, b, view, cap);
            open.c = closed_before(open.c, c, view, cap);
            open.d = closed_before(open.d, d, view, cap);
        }
        let counted = vec4f(0.0, 1.0, 2.0, 3.0) + f32(16u * sixteen);
        let cosines = Sixteen(
            cosines_of(view, a, receiver.normal, counted), cosines_of(view, b, receiver.normal, counted + 4.0),
            cosines_of(view, c, receiver.normal, counted + 8.0), cosines_of(view, d, receiver.normal, counted + 12.0));
        seen += dot(cosines.a, open.a) + dot(cosines.b, open.b) + dot(cosines.c, open.c) + dot(cosines.d, open.d);
        all_of_it += dot(cosines.a + cosines.b + cosines.c + cosines.d, vec4f(1.0));
    }
    if (all_of_it > 0.0) {
        return whole * min(seen / all_of_it, 1.0);
    }
    return whole;
}

// Cosines at the receiver of four directions into a lamp; 0 for those that fill up.
fn cosines_of(view: LampView, shift: Four, normal: vec3f, number: vec4f) -> vec4f {
    let above = along(in_light_space(view, shift), normal) + dot(normal, view.axis);
    return select(vec4f(0.0), max(above, vec4f(0.0)), number < vec4f(frame.lamp_directions));
}
