// Directions that blockers close, one receiver per invocation: twin of `mask/shade/batch.rs`.
#import "common/eye_lobes.wgsl"
#import "common/octahedral.wgsl"
#import "common/receivers.wgsl"
#import "mask/boxes.wgsl"
#import "mask/cap.wgsl"
#import "mask/directions.wgsl"
#import "mask/frame.wgsl"
#import "mask/lamp.wgsl"
#import "mask/lobe.wgsl"
#import "mask/lobe_light.wgsl"
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

// Whether anything is glossy.
override IS_GLOSSY: bool = false;

// Light of a lamp: irradiance, and what lobes that are wider send to the eye of it.
struct LampLight {
    irradiance: vec3f,
    glossy: vec3f,
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
    var glossy = gloss_along_lobes(number, receiver, own);
    for (var lamp = 0u; lamp < frame.lamp_count; lamp++) {
        let light = light_of_lamp(frame.lamps + 2u * lamp, number, receiver, own);
        irradiance += light.irradiance;
        glossy += light.glossy;
    }
    reflect(number, irradiance / PI);
    if (IS_GLOSSY) {
        add_radiance(number, glossy, false);
    }
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

// The part of four directions of a bundle that is open before any sphere; `over_cell` are those that fill cells of what meshes hide
// from themselves.
fn open_before(bundle: Bundle, shift: Four, over_cell: Four, receiver: Receiver, own: OwnPoint) -> vec4f {
    let open = own_open(own, receiver.object, directions_of(bundle, over_cell));
    return open * open_beside_boxes(receiver, directions_of(bundle, shift), bundle.distance);
}

// Sixteen directions of a bundle less its axis.
struct Shifts {
    a: Four,
    b: Four,
    c: Four,
    d: Four,
}

// The part that spheres leave of sixteen directions of a bundle, some of which were closed before.
fn closed_by_spheres(
    before: Sixteen,
    bundle: Bundle,
    shifts: Shifts,
    sharpness: Sixteen,
    receiver: Receiver,
    own: OwnPoint,
) -> Sixteen {
    var open = before;
    for (var number = 0u; number < frame.sphere_count; number++) {
        if (!sees(number, receiver, own)) {
            continue;
        }
        let cap = cap_before(bundle, cap_at(number, receiver));
        if (!cap.may_hide) {
            continue;
        }
        open.a = closed_before(open.a, shifts.a, sharpness.a, cap);
        open.b = closed_before(open.b, shifts.b, sharpness.b, cap);
        open.c = closed_before(open.c, shifts.c, sharpness.c, cap);
        open.d = closed_before(open.d, shifts.d, sharpness.d, cap);
    }
    return open;
}

// Four directions into a lamp.
fn lamp_shift(versine: f32, row: u32) -> Four {
    return spread(versine, tables[row], tables[row + 1u], tables[row + 2u]);
}

fn lamp_open(view: LampView, shift: Four, row: u32, receiver: Receiver, own: OwnPoint) -> vec4f {
    return open_before(view.bundle, shift, lamp_shift(max(view.versine, cell_versine()), row), receiver, own);
}

fn light_of_lamp(first: u32, number: u32, receiver: Receiver, own: OwnPoint) -> LampLight {
    let place = rows[first];
    let radiance = rows[first + 1u].xyz;
    let is_near = rows[first + 1u].w > 0.5;
    let whole = radiance * lamp_form(place, is_near, receiver.position, receiver.normal);
    var light = LampLight(whole, vec3f(0.0));
    if (all(whole == vec3f(0.0))) {
        return light;
    }
    let view = lamp_view(place, is_near, receiver.position, receiver.normal);
    let sharp = vec4f(view.bundle.sharpness);
    var seen = 0.0;
    var all_of_it = 0.0;
    for (var sixteen = 0u; sixteen < frame.lamp_sixteens; sixteen++) {
        let row = frame.spiral + 12u * sixteen;
        let shifts = Shifts(lamp_shift(view.versine, row), lamp_shift(view.versine, row + 3u),
            lamp_shift(view.versine, row + 6u), lamp_shift(view.versine, row + 9u));
        let before = Sixteen(
            lamp_open(view, shifts.a, row, receiver, own), lamp_open(view, shifts.b, row + 3u, receiver, own),
            lamp_open(view, shifts.c, row + 6u, receiver, own), lamp_open(view, shifts.d, row + 9u, receiver, own));
        var open =
            closed_by_spheres(before, view.bundle, shifts, Sixteen(sharp, sharp, sharp, sharp), receiver, own);
        // Directions that fill up don't count.
        let counted = vec4f(0.0, 1.0, 2.0, 3.0) + f32(16u * sixteen);
        let counts = Sixteen(counts_of(counted), counts_of(counted + 4.0), counts_of(counted + 8.0), counts_of(counted + 12.0));
        let cosines = Sixteen(
            cosines_with(view.bundle, receiver.normal, shifts.a), cosines_with(view.bundle, receiver.normal, shifts.b),
            cosines_with(view.bundle, receiver.normal, shifts.c), cosines_with(view.bundle, receiver.normal, shifts.d));
        let all_of_them = counted_cosines(cosines, counts);
        seen += dot_of(all_of_them, open);
        all_of_it += dot(all_of_them.a + all_of_them.b + all_of_them.c + all_of_them.d, vec4f(1.0));
        let lit = Sixteen(open.a * counts.a, open.b * counts.b, open.c * counts.c, open.d * counts.d);
        for (var lobe = 0u; lobe < lobe_count(receiver); lobe++) {
            light.glossy += lobe_over_lamp(lobe_of(number, receiver, lobe), view, shifts, cosines, lit);
        }
    }
    light.glossy *= radiance * (TAU * view.versine / frame.lamp_directions);
    if (all_of_it > 0.0) {
        light.irradiance *= min(seen / all_of_it, 1.0);
    }
    return light;
}

// 1 for directions into a lamp, 0 for those that fill up.
fn counts_of(number: vec4f) -> vec4f {
    return select(vec4f(0.0), vec4f(1.0), number < vec4f(frame.lamp_directions));
}

fn counted_cosines(cosines: Sixteen, counts: Sixteen) -> Sixteen {
    let none = vec4f(0.0);
    return Sixteen(max(cosines.a, none) * counts.a, max(cosines.b, none) * counts.b, max(cosines.c, none) * counts.c,
        max(cosines.d, none) * counts.d);
}

fn dot_of(a: Sixteen, b: Sixteen) -> f32 {
    return dot(a.a, b.a) + dot(a.b, b.b) + dot(a.c, b.c) + dot(a.d, b.d);
}

// Lobes of a receiver, black ones among them.
fn lobe_count(receiver: Receiver) -> u32 {
    if (!IS_GLOSSY) {
        return 0u;
    }
    return cells[frame.objects + 2u * receiver.object + 1u];
}

// A lobe of a receiver toward the eye, in light space.
fn lobe_of(number: u32, receiver: Receiver, lobe: u32) -> Lobe {
    let object = frame.objects + 2u * receiver.object;
    let term = frame.objects + cells[object] + 8u * lobe;
    let strength = vec4u(cells[term], cells[term + 1u], cells[term + 2u], cells[term + 3u]);
    let kind = vec4u(cells[term + 4u], cells[term + 5u], cells[term + 6u], cells[term + 7u]);
    return eye_lobe(number, receiver, frame.eye.xyz, strength, kind);
}

fn is_black(lobe: Lobe) -> bool {
    return all(lobe.scale == vec3f(0.0));
}

// Whether a lobe is narrower than a lamp, so that its own directions are looked along.
fn is_narrow(lobe: Lobe, lamp: LampView) -> bool {
    return 1.0 / (lobe.exponent + 1.0) < lamp.versine;
}

// A sum over sixteen directions into a lamp that is narrower than the lobe.
fn lobe_over_lamp(lobe: Lobe, lamp: LampView, shifts: Shifts, cosines: Sixteen, lit: Sixteen) -> vec3f {
    if (is_black(lobe) || is_narrow(lobe, lamp)) {
        return vec3f(0.0);
    }
    let sharp = vec4f(lamp.bundle.sharpness);
    let bundle = lamp.bundle;
    let a = powers(lobe.exponent, versines_to(bundle, lobe.axis, shifts.a)) * horizon(lobe, cosines.a, sharp);
    let b = powers(lobe.exponent, versines_to(bundle, lobe.axis, shifts.b)) * horizon(lobe, cosines.b, sharp);
    let c = powers(lobe.exponent, versines_to(bundle, lobe.axis, shifts.c)) * horizon(lobe, cosines.c, sharp);
    let d = powers(lobe.exponent, versines_to(bundle, lobe.axis, shifts.d)) * horizon(lobe, cosines.d, sharp);
    return lobe.scale * dot_of(lit, Sixteen(a, b, c, d));
}

// Light that shines into a lobe: as bright everywhere, a level of the map, or light of a lamp's cap alone.
struct Shining {
    // Mean over the lobe of what is everywhere or a map's, radiance of a lamp.
    light: vec3f,
    // Distance from which on nothing is hidden.
    distance: f32,
    is_map: bool,
    level: vec4f,
    is_cap: bool,
    cap: Cap,
}

// Radiance toward the eye of the light that isn't a lamp's, and of lamps that are wider than lobes.
fn gloss_along_lobes(number: u32, receiver: Receiver, own: OwnPoint) -> vec3f {
    var radiance = vec3f(0.0);
    for (var k = 0u; k < lobe_count(receiver); k++) {
        let lobe = lobe_of(number, receiver, k);
        if (is_black(lobe)) {
            continue;
        }
        // The first is what isn't a lamp's.
        for (var source = 0u; source <= frame.lamp_count; source++) {
            let shining = shining_from(source, lobe, receiver);
            if (all(shining.light == vec3f(0.0))) {
                continue;
            }
            let view = lobe_view(lobe.axis, lobe.exponent, shining.distance);
            let sums = along_lobe(lobe, view, shining, receiver, own);
            let share = min(sums.seen / max(sums.all, vec3f(SMALLEST)), vec3f(1.0));
            radiance += lobe.scale * shining.light * share * (TAU * view.versine);
        }
    }
    return radiance;
}

fn shining_from(source: u32, lobe: Lobe, receiver: Receiver) -> Shining {
    let nothing = Cap(vec3f(0.0), NOTHING, 0.0, 0.0);
    if (source == 0u) {
        var level = vec4f(0.0);
        if (frame.level_count > 0u) {
            level = level_of(lobe.exponent, 16.0 * f32(frame.lobe_sixteens));
        }
        let mean = mean_over_lobe(lobe.axis, lobe.exponent);
        return Shining(mean, ENDLESS, frame.level_count > 0u, level, false, nothing);
    }
    let first = frame.lamps + 2u * (source - 1u);
    let is_near = rows[first + 1u].w > 0.5;
    let lamp = lamp_view(rows[first], is_near, receiver.position, receiver.normal);
    let form = lamp_form(rows[first], is_near, receiver.position, receiver.normal);
    let is_seen = is_narrow(lobe, lamp) && form > 0.0;
    let radiance = select(vec3f(0.0), rows[first + 1u].xyz, is_seen);
    return Shining(radiance, lamp.bundle.distance, false, vec4f(0.0), !lamp.is_all_around, cap_of_lamp(lamp));
}

// Sums over the directions of a lobe: all light, and what of it is left with the cosine or above the horizon.
fn along_lobe(lobe: Lobe, view: LobeView, shining: Shining, receiver: Receiver, own: OwnPoint) -> Sums {
    var sums = Sums(vec3f(0.0), vec3f(0.0));
    let lamp = cap_before(view.bundle, shining.cap);
    for (var sixteen = 0u; sixteen < frame.lobe_sixteens; sixteen++) {
        let row = frame.lobe_spiral + 12u * sixteen;
        let shifts = Shifts(shift_along(view.versine, row), shift_along(view.versine, row + 3u),
            shift_along(view.versine, row + 6u), shift_along(view.versine, row + 9u));
        let sharpness = Sixteen(lobe_sharpness(view, tables[row]), lobe_sharpness(view, tables[row + 3u]),
            lobe_sharpness(view, tables[row + 6u]), lobe_sharpness(view, tables[row + 9u]));
        let before = Sixteen(
            lobe_open(view, shifts.a, row, receiver, own), lobe_open(view, shifts.b, row + 3u, receiver, own),
            lobe_open(view, shifts.c, row + 6u, receiver, own), lobe_open(view, shifts.d, row + 9u, receiver, own));
        let open = closed_by_spheres(before, view.bundle, shifts, sharpness, receiver, own);
        sums = add_along(sums, lobe, view, shining, lamp, shifts.a, sharpness.a, open.a, receiver.normal);
        sums = add_along(sums, lobe, view, shining, lamp, shifts.b, sharpness.b, open.b, receiver.normal);
        sums = add_along(sums, lobe, view, shining, lamp, shifts.c, sharpness.c, open.c, receiver.normal);
        sums = add_along(sums, lobe, view, shining, lamp, shifts.d, sharpness.d, open.d, receiver.normal);
    }
    return sums;
}

fn shift_along(versine: f32, row: u32) -> Four {
    return lobe_shift(versine, tables[row], tables[row + 1u], tables[row + 2u]);
}

fn lobe_open(view: LobeView, shift: Four, row: u32, receiver: Receiver, own: OwnPoint) -> vec4f {
    return open_before(view.bundle, shift, shift_along(max(view.versine, cell_versine()), row), receiver, own);
}

fn add_along(
    sums: Sums,
    lobe: Lobe,
    view: LobeView,
    shining: Shining,
    lamp: CapBefore,
    shift: Four,
    sharpness: vec4f,
    open: vec4f,
    normal: vec3f,
) -> Sums {
    var left = open * horizon(lobe, cosines_with(view.bundle, normal, shift), sharpness);
    if (shining.is_cap) {
        // The part of the cells that isn't the lamp's.
        var dark = vec4f(1.0);
        if (lamp.may_hide) {
            dark = closed_before(dark, shift, sharpness, lamp);
        }
        left *= 1.0 - dark;
    }
    var added = sums;
    if (!shining.is_map) {
        added.all += vec3f(4.0);
        added.seen += vec3f(left.x + left.y + left.z + left.w);
        return added;
    }
    let nodes = next_to(shining.level, directions_of(view.bundle, shift));
    for (var k = 0u; k < 4u; k++) {
        let light = tables[nodes[k]].xyz;
        added.all += light;
        added.seen += light * left[k];
    }
    return added;
}
