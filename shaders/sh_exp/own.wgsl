// Own occlusion that a receiver knows, and the cut that it sees: twin of `sh_exp/kernel/own.rs`.
#import "common/constants.wgsl"
#import "common/octahedral.wgsl"
#import "common/receivers.wgsl"
#import "sh_exp/exponential.wgsl"
#import "sh_exp/frame.wgsl"
#import "sh/rotation"

// Added to whole numbers in `tables`, so that none has the bits of a denormal float.
const MARK = 0x40000000u;

// Whole numbers of a row of `tables`.
fn whole_numbers(row: u32) -> vec4u {
    return bitcast<vec4u>(tables[row]) - MARK;
}

// Cells from the centre of the grid over directions to its side, in which small lights are looked for.
override OWN_CELLS: f32 = 16.0;

// Bits of a number in `tables`: those of the fraction of a float between 1 and 2.
const OWN_BITS = 23u;

// How much a receiver knows of its own object: the object hides nothing; vectors; bits for small lights, too.
const HIDES_NOTHING = 1.0;
const HAS_VECTORS = 2.0;
const HAS_BITS = 3.0;

// Two rows of `tables` tell of a receiver that may know its own object's occlusion: the rows of the vertices around it and
// its cut; their weights, and how much is known, or 0.
fn own_row(receiver: Receiver) -> u32 {
    return frame.own_receivers + receiver.group;
}

fn knowledge(receiver: Receiver) -> f32 {
    return tables[own_row(receiver) + 1u].w;
}

// The blockers of a receiver, and which of them are its own object's if it knows that object otherwise.
fn cut_of_receiver(receiver: Receiver) -> Cut {
    if (!OWN_IS_BAKED) {
        return cut_of(receiver.group);
    }
    var cut = cut_of(whole_numbers(own_row(receiver)).w);
    if (knowledge(receiver) >= HIDES_NOTHING) {
        let place = frame.own_spheres + 2u * receiver.object;
        cut.own_first = numbers[place];
        cut.own_count = numbers[place + 1u];
    }
    return cut;
}

// Four of the blocks' values: band by band, row by row.
fn sh_rotation_part(row: u32) -> vec4f {
    let place = frame.own_rotations + 4u * row;
    return bitcast<vec4f>(vec4u(numbers[place], numbers[place + 1u], numbers[place + 2u], numbers[place + 3u]));
}

// Occlusion by its own object, interpolated between the vertices that a receiver lies between, in light space.
fn own_blocked(receiver: Receiver) -> Sh {
    let row = own_row(receiver);
    let vertices = whole_numbers(row);
    let weights = tables[row + 1u];
    var sum = array<vec4f, SH_PARTS>();
    for (var corner = 0u; corner < 3u; corner++) {
        if (weights[corner] != 0.0) {
            for (var part = 0u; part < SH_PARTS; part++) {
                sum[part] += tables[vertices[corner] + part] * weights[corner];
            }
        }
    }
    return sh_rotated(sh_of_parts(sum), receiver.object * SH_ROTATION_PARTS);
}

// Visibility past all other objects, less what its own hides from a receiver.
fn past_own(receiver: Receiver, visibility: Sh) -> Sh {
    if (!OWN_IS_BAKED || knowledge(receiver) < HAS_VECTORS) {
        return visibility;
    }
    // V (1 - B) - 1
    var h = sh_scaled_plus(sh_product(visibility, own_blocked(receiver)), -1.0, visibility);
    h.h0 -= SQRT_4PI;
    h = limit_difference(h);
    h.h0 += SQRT_4PI;
    return h;
}

// How much the own object leaves of a small light along a direction; 1 where that isn't known.
fn own_open(receiver: Receiver, direction: vec3f) -> f32 {
    if (!OWN_IS_BAKED || knowledge(receiver) < HAS_BITS) {
        return 1.0;
    }
    let rows = placements[receiver.object].direction;
    let in_object = rows[0].xyz * direction.x + rows[1].xyz * direction.y + rows[2].xyz * direction.z;
    let found = octahedral_lookup(in_object, OWN_CELLS);
    let row = own_row(receiver);
    let vertices = whole_numbers(row);
    let weights = tables[row + 1u];
    var hidden = 0.0;
    for (var corner = 0u; corner < 3u; corner++) {
        for (var k = 0u; k < 3u; k++) {
            let number = found.nodes[k] / OWN_BITS;
            let word = bitcast<vec4u>(tables[vertices[corner] + SH_PARTS + number / 4u])[number % 4u];
            hidden += weights[corner] * found.weights[k] * f32((word >> (found.nodes[k] % OWN_BITS)) & 1u);
        }
    }
    return 1.0 - hidden;
}
