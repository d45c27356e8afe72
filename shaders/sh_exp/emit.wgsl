// First pass of reflections: light at the sample points of a sphere becomes its radiance vector [Guerrero2007, eq. 4.20]:
// twin of `sh_exp/prepare/emitters.rs`.
//
//     r = R Σ_j M_j W_j
//
// One workgroup per sphere and channel, one invocation per coefficient.

struct Emitter {
    // First sample point and number of them.
    first_sample: u32,
    samples: u32,
    // Place in `weights` of W_j of the first.
    weights: u32,
    // Place in `rotations` of R, band by band, row by row.
    rotation: u32,
}

struct Rounds {
    // Channels of radiance, and of W_j.
    channels: u32,
    surface_channels: u32,
    // Coefficients that are not 0.
    used: u32,
    // Sample points of all spheres.
    samples: u32,
}

@group(0) @binding(0) var<uniform> rounds: Rounds;
@group(0) @binding(1) var<storage, read> emitters: array<Emitter>;
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read> rotations: array<f32>;
// M_j: light of white receivers at the sample points, channel by channel.
@group(0) @binding(4) var<storage, read> light: array<f32>;
@group(0) @binding(5) var<storage, read_write> radiance: array<f32>;

var<workgroup> sums: array<f32, SH_COUNT>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let coefficient = local.x;
    let emitter = emitters[group.x / rounds.channels];
    let channel = group.x % rounds.channels;
    if (coefficient < SH_COUNT) {
        let surface_channel = channel % rounds.surface_channels;
        var sum = 0.0;
        for (var sample = 0u; sample < emitter.samples; sample++) {
            let value = weights[emitter.weights + (sample * rounds.surface_channels + surface_channel) * SH_COUNT + coefficient];
            sum += light[channel * rounds.samples + emitter.first_sample + sample] * value;
        }
        sums[coefficient] = sum;
    }
    workgroupBarrier();
    if (coefficient >= 4u * SH_PARTS) {
        return;
    }
    var turned = 0.0;
    if (coefficient < rounds.used) {
        // The band's first coefficient and first number of R: 1 + 9 + .. + (2l - 1)².
        var band = 0u;
        var before = 0u;
        while ((band + 1u) * (band + 1u) <= coefficient) {
            before += (2u * band + 1u) * (2u * band + 1u);
            band++;
        }
        let width = 2u * band + 1u;
        let row = emitter.rotation + before + (coefficient - band * band) * width;
        for (var k = 0u; k < width; k++) {
            turned += rotations[row + k] * sums[band * band + k];
        }
    }
    radiance[group.x * 4u * SH_PARTS + coefficient] = turned;
}
