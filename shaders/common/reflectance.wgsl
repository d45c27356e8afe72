// Lobes of reflectance toward the eye [Meunier2009, 5.1]: twin of `halfshade_scene::Reflectance::lobes`.
#import "common/constants.wgsl"
#import "common/near_zero.wgsl"

const PHONG = 0u;
const MODIFIED_PHONG = 1u;
const LAFORTUNE = 2u;

// One term of a model of reflectance.
struct Term {
    scale: vec3f,
    exponent: f32,
    // The diagonal of a Lafortune model's matrix.
    axis: vec3f,
    model: u32,
}

// `scale · max(axis·v, 0)^exponent`, and the cosine if it has one; black where the scale is 0.
struct Lobe {
    axis: vec3f,
    exponent: f32,
    scale: vec3f,
    times_cosine: bool,
}

// The lobe of a term about unit `normal` and `tangent`, as seen along unit `to_eye`.
fn lobe_toward(term: Term, normal: vec3f, tangent: vec3f, to_eye: vec3f) -> Lobe {
    let black = Lobe(normal, 0.0, vec3f(0.0), false);
    let up = dot(normal, to_eye);
    if (!(up > 0.0)) {
        return black;
    }
    if (term.model != LAFORTUNE) {
        let normalization = select(1.0, (term.exponent + 2.0) / TAU, term.model == MODIFIED_PHONG);
        let mirrored = normalize(2.0 * up * normal - to_eye);
        return Lobe(mirrored, term.exponent, term.scale * normalization, term.model == MODIFIED_PHONG);
    }
    let bitangent = cross(normal, tangent);
    let local = vec3f(dot(tangent, to_eye), dot(bitangent, to_eye), up);
    let stretched = term.axis * local;
    let size = length(stretched);
    if (!(size > SMALLEST)) {
        return black;
    }
    // Next to 1 the size is had from what its square lacks of that: off by rounding it would change a power of 10^5 by a
    // percent.
    let lacking = dot((vec3f(1.0) - term.axis) * (vec3f(1.0) + term.axis), local * local);
    let log_size = select(log(size), 0.5 * log_one_minus(lacking), abs(lacking) < 0.25);
    let axis = normalize(stretched.x * tangent + stretched.y * bitangent + stretched.z * normal);
    return Lobe(axis, term.exponent, term.scale * exp(term.exponent * log_size), true);
}
