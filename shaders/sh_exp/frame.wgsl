// The data of a frame of sh-exp.

struct Blocker {
    center: vec3f,
    radius: f32,
    // How much of each band of its logarithm counts.
    low_factors: vec4f,
    high_factors: vec4f,
    // Its number among the spheres of all levels.
    emitter: u32,
    // Factor of its reflected light.
    reflection_factor: f32,
    padding: vec2u,
}

// A table of the optimal linear form: its first row of `tables`, last entry, largest magnitude, entries per magnitude.
struct LinearTable {
    row: u32,
    last: f32,
    limit: f32,
    per_magnitude: f32,
}

struct Frame {
    // Clamped cosine over π by band: constant light.
    low_cosine: vec4f,
    high_cosine: vec4f,
    // The same without a window: reflected light.
    low_reflectance: vec4f,
    high_reflectance: vec4f,
    // Constant light; unused by a map.
    light: vec4f,
    sun_direction: vec4f,
    // Reflected radiance of a white surface that faces the sun; its sine of the angular radius.
    sun_perpendicular: vec4f,
    // Tables of shadows and of reflections.
    shadow_table: LinearTable,
    reflection_table: LinearTable,
    // Rows of `tables` at which there begin: the light by normal, the sun's basis, logarithms by angular radius, form factors.
    light_table: u32,
    sun_table: u32,
    log_table: u32,
    form_table: u32,
    // Cells of the grid over normals.
    grid_cells: f32,
    // Place in `numbers` of the masks of spheres that intersect.
    masks: u32,
    // The first row of `radiating` about the surroundings of objects.
    ground: u32,
    // The row of `tables` at which points of exposed shares begin.
    fan: u32,
    // Rows of the rotation into the space in which points of exposed shares are fixed.
    share_space: array<vec4f, 3>,
    // The row of `tables` at which rows of receivers begin that know their own object's occlusion.
    own_receivers: u32,
    // Place in `numbers` of the rotations of objects, and of their spheres.
    own_rotations: u32,
    own_spheres: u32,
    // Place in `numbers` of the lamps: direction or centre, sine of the angular radius or radius, radiance, 1 if it is distant.
    lamps: u32,
    // The row of `tables` at which points of lamps begin, as those of exposed shares do.
    lamp_fan: u32,
    // The row of `tables` at which mean normals of spheres begin.
    mean_normals: u32,
    padding: vec2u,
}

@group(1) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var<storage, read> blockers: array<Blocker>;
// Eight counts, then first blocker and number of blockers, by group of receivers; then masks, see `is_skipped`. Counts aren't in
// `frame`: Mesa's driver in software compiles numbers of a uniform that decide branches into the kernel, with every dispatch.
@group(1) @binding(2) var<storage, read> numbers: array<u32>;
// Blockers by angular radius from row 0 on, and the tables that `frame` tells of.
@group(1) @binding(3) var<storage, read> tables: array<vec4f>;
// Radiance of every sphere, channel by channel in rows of four; then the surroundings of objects, see `ground_radiance`.
@group(1) @binding(4) var<storage, read> radiating: array<vec4f>;

// Whether meshes tell what objects hide from themselves.
override OWN_IS_BAKED: bool = false;

// Blockers that a group of receivers sees, and the spheres of their own object if they don't hide the environment: the first
// of its numbers, and how many.
struct Cut {
    first: u32,
    end: u32,
    own_first: u32,
    own_count: u32,
}

fn cut_of(group: u32) -> Cut {
    let place = 8u + 2u * group;
    let first = numbers[place];
    return Cut(first, first + numbers[place + 1u], 0u, 0u);
}

// Whether a blocker of a cut hides the environment.
fn hides(blocker: Blocker, cut: Cut) -> bool {
    return !OWN_IS_BAKED || (blocker.emitter - cut.own_first >= cut.own_count);
}

// Channels of light by normal; 0 of constant light.
fn light_channels() -> u32 {
    return numbers[0];
}

// Channels of what spheres radiate.
fn radiance_channels() -> u32 {
    return numbers[1];
}

// Rows of `radiating` about the surroundings of an object; 0: there are none.
fn ground_rows() -> u32 {
    return numbers[2];
}

fn has_sun() -> bool {
    return numbers[3] != 0u;
}

fn lamp_count() -> u32 {
    return numbers[4];
}
