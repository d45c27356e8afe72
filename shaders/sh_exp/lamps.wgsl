// Suns, small bright parts of a map and spherical lights, by what spheres leave of their discs: twin of
// `sh_exp/kernel/lamps.rs`.
#import "common/cap.wgsl"
#import "common/constants.wgsl"
#import "sh_exp/blocker.wgsl"
#import "sh_exp/light.wgsl"
#import "sh_exp/own.wgsl"

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

// Points of a lamp, four by four.
struct LampPoints {
    x: mat4x4f,
    y: mat4x4f,
    z: mat4x4f,
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
    view.versine = sine * sine / (1.0 + sqrt(max(1.0 - sine * sine, 0.0)));
    view.chord = sqrt(2.0 * view.versine);
    view.spacing = max(view.chord / sqrt(LAMP_POINTS), 1e-12);
    return view;
}

fn lamp_points(view: LampView) -> LampPoints {
    let d = view.direction;
    // Two unit vectors at right angles to the direction and each other, continuous but for -Y.
    let a = -1.0 / max(1.0 + d.y, 1e-4);
    let b = d.x * d.z * a;
    let u = vec3f(d.x * d.x * a + 1.0, -d.x, b);
    let v = vec3f(b, -d.z, d.z * d.z * a + 1.0);
    var points = LampPoints();
    for (var four = 0u; four < 4u; four++) {
        let within = (vec4f(0.5, 1.5, 2.5, 3.5) + 4.0 * f32(four)) / LAMP_POINTS;
        let fall = view.versine * within;
        let radius = sqrt(fall * (2.0 - fall));
        let along = radius * tables[frame.spiral + 2u * four];
        let across = radius * tables[frame.spiral + 2u * four + 1u];
        points.x[four] = u.x * along + v.x * across + (d.x - fall * d.x);
        points.y[four] = u.y * along + v.y * across + (d.y - fall * d.y);
        points.z[four] = u.z * along + v.z * across + (d.z - fall * d.z);
    }
    return points;
}

// Openness that a sphere leaves to four points of which `open` is left.
fn uncovered(open: vec4f, x: vec4f, y: vec4f, z: vec4f, cover: Cover) -> vec4f {
    let a = x - cover.middle.x;
    let b = y - cover.middle.y;
    let c = z - cover.middle.z;
    let inside = (cover.chord - sqrt(a * a + b * b + c * c)) * cover.per_spacing;
    return min(open, 1.0 - clamp(inside + 0.5, vec4f(0.0), vec4f(1.0)) * cover.factor);
}

// The mean over all points of what is left, weighted by the cosine.
fn open_share(view: LampView, receiver: Receiver, cut: Cut) -> f32 {
    let points = lamp_points(view);
    var first = vec4f(1.0);
    var second = vec4f(1.0);
    var third = vec4f(1.0);
    var fourth = vec4f(1.0);
    let per_spacing = 1.0 / view.spacing;
    for (var i = cut.first; i < cut.end; i++) {
        let blocker = blockers[i];
        let seen = seen_from(blocker, receiver.position, receiver.normal);
        if (seen.sin_squared <= 0.0 || !hides(blocker, cut)) {
            continue;
        }
        let chord = sqrt(2.0 * seen.sin_squared / (1.0 + sqrt(max(1.0 - seen.sin_squared, 0.0))));
        let apart = seen.direction - view.direction;
        let reach = chord + view.chord + view.spacing;
        if (dot(apart, apart) < reach * reach) {
            // From before the lamp to behind it over a diameter.
            let nearer = view.distance - length(blocker.center - receiver.position);
            let before = clamp(nearer * (0.5 / blocker.radius) + 0.5, 0.0, 1.0);
            let area = min(chord * per_spacing, 1.0);
            let cover = Cover(seen.direction, chord, area * area * before, per_spacing);
            first = uncovered(first, points.x[0], points.y[0], points.z[0], cover);
            second = uncovered(second, points.x[1], points.y[1], points.z[1], cover);
            third = uncovered(third, points.x[2], points.y[2], points.z[2], cover);
            fourth = uncovered(fourth, points.x[3], points.y[3], points.z[3], cover);
        }
    }
    var sum = 0.0;
    var weights = 0.0;
    let open = mat4x4f(first, second, third, fourth);
    for (var four = 0u; four < 4u; four++) {
        let cosine = points.x[four] * receiver.normal.x + points.y[four] * receiver.normal.y
            + points.z[four] * receiver.normal.z;
        // So that a lamp of which no point is above the horizon has a mean, too.
        let weight = max(cosine, vec4f(1e-6));
        sum += dot(open[four], weight);
        weights += dot(weight, vec4f(1.0));
    }
    return sum / weights;
}
