// Suns, small bright parts of a map and spherical lights, by what spheres leave of their discs: twin of
// `sh_exp/kernel/lamps.rs`.
#import "common/cap.wgsl"
#import "common/constants.wgsl"
#import "sh_exp/blocker.wgsl"
#import "sh_exp/light.wgsl"
#import "sh_exp/own.wgsl"
#import "sh_exp/shares.wgsl"

const LAMP_POINTS = 16.0;

// A lamp as a receiver sees it.
struct LampView {
    direction: vec3f,
    // Irradiance for radiance 1 over π, if nothing is in the way.
    reflected: f32,
    // To its nearest point.
    distance: f32,
    // Chord of its angular radius, and from a point to the rim of what it stands for.
    chord: f32,
    spacing: f32,
    versine: f32,
}

// A sphere before a lamp: middle and chord of its cap, and how much it counts.
struct Cover {
    middle: vec3f,
    chord: f32,
    factor: f32,
    per_spacing: f32,
}

fn lamp_number(lamp: u32, number: u32) -> f32 {
    return bitcast<f32>(numbers[frame.lamps + 8u * lamp + number]);
}

fn lamp_vector(lamp: u32, number: u32) -> vec3f {
    return vec3f(lamp_number(lamp, number), lamp_number(lamp, number + 1u), lamp_number(lamp, number + 2u));
}

// Outgoing radiance of a white receiver under all lamps. A lamp that surrounds it is constant light.
fn lamp_light(receiver: Receiver, cut: Cut, visibility: Sh) -> vec3f {
    var radiance = vec3f(0.0);
    for (var lamp = 0u; lamp < lamp_count(); lamp++) {
        if (surrounds(lamp, receiver)) {
            radiance += lamp_vector(lamp, 4u) * constant_share(receiver.normal, visibility);
            continue;
        }
        let view = lamp_view(lamp, receiver);
        if (view.reflected > 0.0) {
            let share = open_share(view, receiver, cut) * own_open(receiver, view.direction);
            radiance += lamp_vector(lamp, 4u) * (share * view.reflected);
        }
    }
    return radiance;
}

fn surrounds(lamp: u32, receiver: Receiver) -> bool {
    let offset = lamp_vector(lamp, 0u) - receiver.position;
    return lamp_number(lamp, 7u) == 0.0 && length(offset) <= lamp_number(lamp, 3u);
}

fn lamp_view(lamp: u32, receiver: Receiver) -> LampView {
    let place = lamp_vector(lamp, 0u);
    let size = lamp_number(lamp, 3u);
    var view = LampView();
    var sine = size;
    view.direction = place;
    view.distance = ENDLESS;
    if (lamp_number(lamp, 7u) == 0.0) {
        let offset = place - receiver.position;
        let distance = length(offset);
        let inverse = 1.0 / max(distance, SMALLEST);
        view.direction = offset * inverse;
        sine = min(size * inverse, 1.0);
        view.distance = distance - size;
    }
    let cosine = dot(view.direction, receiver.normal);
    view.reflected = sine * sine * clamp(cosine, 0.0, 1.0);
    if (abs(cosine) < sine * 1.000001) {
        view.reflected = cap_irradiance(cosine, sine) / PI;
    }
    view.versine = versine_of(sine * sine);
    view.chord = sqrt(2.0 * view.versine);
    view.spacing = max(view.chord / sqrt(LAMP_POINTS), 1e-12);
    return view;
}

// Four of the points of a lamp.
fn lamp_points(view: LampView, four: u32) -> Points {
    return points_of(Cap(view.direction, view.versine), frame.lamp_fan + 4u * four);
}

// Openness that a sphere leaves to four points of which `open` is left.
fn uncovered(open: vec4f, points: Points, cover: Cover) -> vec4f {
    let a = points.x - cover.middle.x;
    let b = points.y - cover.middle.y;
    let c = points.z - cover.middle.z;
    let inside = (cover.chord - sqrt(a * a + b * b + c * c)) * cover.per_spacing;
    return min(open, 1.0 - clamp(inside + 0.5, vec4f(0.0), vec4f(1.0)) * cover.factor);
}

// Sum of what is left of four points by the cosine, and of the cosines.
fn weighted(open: vec4f, points: Points, normal: vec3f) -> vec2f {
    let cosine = points.x * normal.x + points.y * normal.y + points.z * normal.z;
    // So that a lamp of which no point is above the horizon has a mean, too.
    let weight = max(cosine, vec4f(1e-6));
    return vec2f(dot(open, weight), dot(weight, vec4f(1.0)));
}

// The mean over all points of what is left, weighted by the cosine.
fn open_share(view: LampView, receiver: Receiver, cut: Cut) -> f32 {
    let a = lamp_points(view, 0u);
    let b = lamp_points(view, 1u);
    let c = lamp_points(view, 2u);
    let d = lamp_points(view, 3u);
    // How much is left of each.
    var of_a = vec4f(1.0);
    var of_b = vec4f(1.0);
    var of_c = vec4f(1.0);
    var of_d = vec4f(1.0);
    let per_spacing = 1.0 / view.spacing;
    for (var i = cut.first; i < cut.end; i++) {
        let blocker = blockers[i];
        let seen = seen_from(blocker, receiver.position, receiver.normal);
        if (seen.sin_squared <= 0.0 || !hides(blocker, cut)) {
            continue;
        }
        let chord = sqrt(2.0 * versine_of(seen.sin_squared));
        let apart = seen.direction - view.direction;
        let reach = chord + view.chord + view.spacing;
        if (dot(apart, apart) < reach * reach) {
            // From before the lamp to behind it over a diameter.
            let nearer = view.distance - length(blocker.center - receiver.position);
            let before = clamp(nearer * (0.5 / blocker.radius) + 0.5, 0.0, 1.0);
            let area = min(chord * per_spacing, 1.0);
            let cover = Cover(seen.direction, chord, area * area * before, per_spacing);
            of_a = uncovered(of_a, a, cover);
            of_b = uncovered(of_b, b, cover);
            of_c = uncovered(of_c, c, cover);
            of_d = uncovered(of_d, d, cover);
        }
    }
    let normal = receiver.normal;
    let sums = weighted(of_a, a, normal) + weighted(of_b, b, normal) + weighted(of_c, c, normal) + weighted(of_d, d, normal);
    return sums.x / sums.y;
}
