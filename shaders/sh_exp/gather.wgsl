// Second pass of reflections: radiance of all spheres at a receiver [Guerrero2007, 4.3.3]: twin of `sh_exp/kernel/gather.rs`.
//
// The processor sorts the spheres of eight receivers and keeps the order for the next eight. Here nothing is kept: the eight
// nearest spheres that haven't been walked yet are found by going through all, n/8 times.
#import "common/constants.wgsl"
#import "sh_exp/blocker.wgsl"
#import "sh_exp/exponential.wgsl"
#import "sh_exp/ground.wgsl"
#import "sh_exp/own.wgsl"

// Whether spheres are ordered by power distance.
override BY_POWER: bool = false;
// Whether intersecting spheres of an object don't cover each other.
override IS_PRECOMPUTED: bool = false;
// Whether sums over nearer spheres are found one by one.
override IS_QUADRATIC: bool = false;
// Intervals of the form factors by sine.
override FORM_INTERVALS: f32 = 256.0;
// Whether the average over a sphere knows the receiver, and cells along each axis of the table of mean normals.
override KNOWS_RECEIVER: bool = false;
override MEAN_CELLS: f32 = 32.0;

const NONE = 0xffffffffu;

struct Gathered {
    radiance: vec3f,
    log_sum: Sh,
}

// Eight spheres from near to far: keys of the order, and places among the blockers.
struct Nearest {
    low_keys: vec4f,
    high_keys: vec4f,
    low_places: vec4u,
    high_places: vec4u,
}

fn order_key(blocker: Blocker, position: vec3f) -> f32 {
    let offset = blocker.center - position;
    // Nothing is left to the compiler to fuse or not: a sphere has the same key wherever it is asked for.
    let squared = fma(offset.z, offset.z, fma(offset.y, offset.y, offset.x * offset.x));
    return select(squared, fma(-blocker.radius, blocker.radius, squared), BY_POWER);
}

// The nearest eight of a cut after the one with this key and place. At equal distances the first of the list comes first.
fn nearest_after(key: f32, place: u32, position: vec3f, cut: Cut) -> Nearest {
    var found = Nearest(vec4f(ENDLESS), vec4f(ENDLESS), vec4u(NONE), vec4u(NONE));
    for (var i = cut.first; i < cut.end; i++) {
        let its_key = order_key(blockers[i], position);
        let is_left = (its_key > key) || (its_key == key && i > place) || (place == NONE);
        if (is_left && (its_key < found.high_keys.w)) {
            found = inserted(found, its_key, i);
        }
    }
    return found;
}

// Every element after the new one makes way by one place.
fn inserted(list: Nearest, key: f32, place: u32) -> Nearest {
    let low_before = vec4f(-ENDLESS, list.low_keys.xyz);
    let high_before = vec4f(list.low_keys.w, list.high_keys.xyz);
    let keys = vec4f(key);
    let places = vec4u(place);
    return Nearest(
        select(select(list.low_keys, keys, keys < list.low_keys), low_before, keys < low_before),
        select(select(list.high_keys, keys, keys < list.high_keys), high_before, keys < high_before),
        select(select(list.low_places, places, keys < list.low_keys), vec4u(NONE, list.low_places.xyz), keys < low_before),
        select(
            select(list.high_places, places, keys < list.high_keys),
            vec4u(list.low_places.w, list.high_places.xyz),
            keys < high_before,
        ),
    );
}

// Form factors of a sphere by its sine, by bands from the lowest.
fn form_factors(sine: f32) -> array<vec4f, 2> {
    let at = clamp(sine, 0.0, 1.0) * FORM_INTERVALS;
    let interval = min(floor(at), FORM_INTERVALS - 1.0);
    let t = at - interval;
    let row = frame.form_table + 2u * u32(interval);
    return array<vec4f, 2>(
        (tables[row + 2u] - tables[row]) * t + tables[row],
        (tables[row + 3u] - tables[row + 1u]) * t + tables[row + 1u],
    );
}

// A node of the table of mean normals: two in a row.
fn mean_normal_node(number: u32) -> vec2f {
    let row = tables[frame.mean_normals + number / 2u];
    return select(row.xy, row.zw, number % 2u == 1u);
}

// Parts of the mean normal along the direction to a sphere and at a right angle to that: twin of
// `halfshade_sh::mean_normal::MeanNormalTable::lookup`.
fn mean_normal(sine: f32, cosine: f32) -> vec2f {
    let s = clamp(sine, 0.0, 1.0);
    let at = vec2f(s, clamp((cosine + s) / (1.0 + s), 0.0, 1.0)) * MEAN_CELLS;
    let cell = min(floor(at), vec2f(MEAN_CELLS - 1.0));
    let t = at - cell;
    let side = u32(MEAN_CELLS) + 1u;
    let first = u32(cell.x) * side + u32(cell.y);
    let near = mix(mean_normal_node(first), mean_normal_node(first + 1u), t.y);
    let far = mix(mean_normal_node(first + side), mean_normal_node(first + side + 1u), t.y);
    return mix(near, far, t.x);
}

// Weights of a sphere's radiance in its average over what a receiver sees of it.
fn average_weights(blocker: Blocker, basis: Sh, sine: f32, position: vec3f, normal: vec3f) -> Sh {
    if (!KNOWS_RECEIVER) {
        let form = form_factors(sine);
        // From the sphere to the receiver: the opposite direction turns the sign of odd bands.
        let signs = vec4f(1.0, -1.0, 1.0, -1.0);
        return sh_times_bands(basis, sh_bands(form[0] * signs, form[1] * signs));
    }
    let offset = blocker.center - position;
    let per_distance = 1.0 / sqrt(max(dot(offset, offset), SMALLEST));
    let direction = offset * per_distance;
    let of_sphere = min(blocker.radius * per_distance, 1.0);
    let cosine = dot(direction, normal);
    let parts = mean_normal(of_sphere, cosine);
    let of_normal = parts.y / sqrt(max(1.0 - cosine * cosine, 1e-12));
    let mean = direction * (parts.x - of_normal * cosine) + normal * of_normal;
    let size = sqrt(max(dot(mean, mean), SMALLEST));
    let form = form_factors(of_sphere);
    let scale = size / max(form[0].y, 0.5);
    return sh_times_bands(sh_basis(mean / size), sh_bands(form[0] * vec4f(1.0, vec3f(scale)), form[1] * scale));
}

// Radiance that a sphere sends to a receiver that sees it like this: L̃ [Guerrero2007, eq. 4.25].
fn radiated(blocker: Blocker, basis: Sh, sine: f32, position: vec3f, normal: vec3f) -> vec3f {
    let weights = average_weights(blocker, basis, sine, position, normal);
    var radiance = vec3f(0.0);
    for (var channel = 0u; channel < radiance_channels(); channel++) {
        let first = (blocker.emitter * radiance_channels() + channel) * SH_PARTS;
        for (var part = 0u; part < SH_PARTS; part++) {
            radiance[channel] += dot(radiating[first + part], sh_part(weights, part));
        }
    }
    return select(radiance, radiance.xxx, radiance_channels() == 1u) * blocker.reflection_factor;
}

// Whether sphere `other` doesn't cover `sphere`, though it may be nearer. Three numbers per sphere say which spheres are of
// its object and level, from the first on, and where there is a bit for each of them.
fn is_skipped(sphere: u32, other: u32) -> bool {
    if (!IS_PRECOMPUTED) {
        return false;
    }
    let row = frame.masks + 3u * sphere;
    let bit = other - numbers[row];
    return (other >= numbers[row]) && (bit < numbers[row + 1u])
        && ((numbers[numbers[row + 2u] + bit / 32u] >> (bit % 32u)) & 1u) == 1u;
}

// Logarithms of the spheres nearer than the one at `place` that cover it, or of those that don't.
fn sum_of_nearer(place: u32, position: vec3f, normal: vec3f, cut: Cut, of_skipped: bool) -> Sh {
    let key = order_key(blockers[place], position);
    var sum = Sh();
    for (var i = cut.first; i < cut.end; i++) {
        let other = blockers[i];
        let its_key = order_key(other, position);
        let is_nearer = (its_key < key) || (its_key == key && i < place);
        if (is_nearer && hides(other, cut) && is_skipped(blockers[place].emitter, other.emitter) == of_skipped) {
            let seen = seen_from(other, position, normal);
            if (seen.sin_squared > 0.0) {
                sum = sh_add_lobe(seen.direction, zonal_log(other, seen.sin_squared, frame.log_table), sum);
            }
        }
    }
    return sum;
}

// Σ L̃_i Ṽ_i, and Σ log B_i on the way. What the own object hides of a receiver that knows it from the mesh, radiates that
// object's average.
fn gather(receiver: Receiver, cut: Cut) -> Gathered {
    let position = receiver.position;
    let normal = receiver.normal;
    var brdf = reflectance(normal);
    let form = reflection_form();
    var gathered = Gathered(vec3f(0.0), Sh());
    // Light that the spheres so far have left.
    var left = brdf.h0 * SQRT_4PI;
    if (OWN_IS_BAKED && knowledge(receiver) >= HAS_VECTORS) {
        brdf = sh_scaled_plus(sh_product(brdf, own_blocked(receiver)), -1.0, brdf);
        gathered.radiance = own_average(receiver, cut) * max(left - brdf.h0 * SQRT_4PI, 0.0);
        left = brdf.h0 * SQRT_4PI;
    }
    var key = -ENDLESS;
    var place = NONE;
    for (var block = cut.first; block < cut.end; block += 8u) {
        var next = Nearest();
        if (!IS_QUADRATIC) {
            next = nearest_after(key, place, position, cut);
        }
        for (var k = 0u; k < 8u; k++) {
            if (IS_QUADRATIC) {
                place = select(NONE, block + k, block + k < cut.end);
            } else {
                key = select(next.low_keys, next.high_keys, k >= 4u)[k & 3u];
                place = select(next.low_places, next.high_places, k >= 4u)[k & 3u];
            }
            if (place == NONE) {
                return gathered;
            }
            let blocker = blockers[place];
            let seen = seen_from(blocker, position, normal);
            if (seen.sin_squared <= 0.0 || !hides(blocker, cut)) {
                continue;
            }
            let basis = sh_basis(seen.direction);
            let log = sh_times_bands(basis, zonal_log(blocker, seen.sin_squared, frame.log_table));
            let radiance = radiated(blocker, basis, sqrt(seen.sin_squared), position, normal);
            if (IS_PRECOMPUTED || IS_QUADRATIC) {
                if (any(radiance != vec3f(0.0))) {
                    var before = gathered.log_sum;
                    if (IS_QUADRATIC) {
                        before = sum_of_nearer(place, position, normal, cut, false);
                    } else {
                        before = sh_scaled_plus(sum_of_nearer(place, position, normal, cut, true), -1.0, before);
                    }
                    let visible = exponential_dot(before, brdf, form) - exponential_dot(sh_plus(before, log), brdf, form);
                    gathered.radiance += radiance * visible;
                }
                gathered.log_sum = sh_plus(gathered.log_sum, log);
            } else {
                gathered.log_sum = sh_plus(gathered.log_sum, log);
                let after = exponential_dot(gathered.log_sum, brdf, form);
                gathered.radiance += radiance * (left - after);
                left = after;
            }
        }
    }
    return gathered;
}

// Average radiance of the own object, sphere by sphere by its solid angle times the receiver's cosine.
fn own_average(receiver: Receiver, cut: Cut) -> vec3f {
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = cut.first; i < cut.end; i++) {
        let blocker = blockers[i];
        if (!hides(blocker, cut)) {
            let seen = seen_from(blocker, receiver.position, receiver.normal);
            let weight = seen.sin_squared * max(dot(seen.direction, receiver.normal), 0.0);
            if (weight > 0.0) {
                let sine = sqrt(seen.sin_squared);
                let basis = sh_basis(seen.direction);
                sum += radiated(blocker, basis, sine, receiver.position, receiver.normal) * weight;
                weights += weight;
            }
        }
    }
    return sum / max(weights, SMALLEST);
}
