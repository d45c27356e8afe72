//! First pass of reflections [Guerrero2007, 4.3.2]: as many rounds as there are bounces, each lit by the spheres of the one
//! before, as chapter 7 proposes.

use super::{emitters, frame::FrameData, ground::GroundView};
use crate::sh_exp::{
    bake::{Tables, reflections::ReflectionTables},
    kernel::{Blockers, OwnSpheres, Receivers8, gather::Gather},
    prepare::cuts::{CutOf, Cuts},
    settings::Ratios,
    shade::{Shader, batches::radiating},
};
use halfshade_scene::{Frame, RadianceBuffer, RadianceMut, Receivers};
use halfshade_sh::dispatch_bands;
use wide::f32x8;

/// Sample points per unit of parallel work.
const SAMPLE_POINT_CHUNK: usize = 256;

/// Lets all spheres radiate, and objects without spheres if they are seen.
pub(crate) fn run(tables: &Tables, reflections: &ReflectionTables, data: &mut FrameData, frame: &Frame<'_>) {
    let channels = reflections.channels(data.is_grey());
    emitters::place(reflections, frame, &mut data.points);
    data.radiance = Default::default();
    let points_on_ground = |ground: &Option<GroundView>| ground.as_ref().map_or(0, |ground| ground.points.len());
    let mut light = RadianceBuffer::zeros(data.points.receivers.len());
    let mut from_ground = RadianceBuffer::zeros(points_on_ground(&data.ground));
    for _ in 0..reflections.bounces {
        let shader = Shader { tables, data };
        let points = &data.points;
        shade_points(shader, points.receivers.view(), Some(&points.emitters), light.view_mut());
        if let Some(ground) = &data.ground {
            shade_points(shader, ground.points.view(), None, from_ground.view_mut());
        }
        if let (Some(ground), Some(tables)) = (&mut data.ground, &tables.ground) {
            ground.shine(tables, &from_ground);
        }
        emitters::radiate(reflections, frame, channels, &light, &data.turns, &mut data.radiance);
    }
    if tables.cut.ratios == Ratios::On && data.cuts.is_coarse() && !data.radiance.is_dark() {
        let mut cuts = std::mem::take(&mut data.cuts);
        // `bake` made sure that there is a kernel for this number of bands.
        let _: Option<()> =
            dispatch_bands!(tables.bands, N => scale_reflections::<N>(tables, reflections, data, &mut cuts));
        data.cuts = cuts;
    }
}

/// Shades sample points, in parallel; those of spheres by `emitters`.
fn shade_points(shader: Shader<'_>, receivers: Receivers<'_>, emitters: Option<&[u32]>, out: RadianceMut<'_>) {
    let count = receivers.len();
    if count <= SAMPLE_POINT_CHUNK {
        return shader.shade_by(receivers, emitters.map_or(CutOf::Cluster, CutOf::Emitter), out);
    }
    let middle = count / 2;
    let (left, right) = out.split_at(middle);
    rayon::join(
        || shade_points(shader, receivers.slice(0..middle), emitters.map(|of| &of[..middle]), left),
        || shade_points(shader, receivers.slice(middle..count), emitters.map(|of| &of[middle..]), right),
    );
}

/// Ratios of reflected light for the parents in `cuts`.
fn scale_reflections<const N: usize>(
    tables: &Tables,
    reflections: &ReflectionTables,
    data: &FrameData,
    cuts: &mut Cuts,
) {
    let radiating = radiating(reflections, data);
    let mut gather = Gather::<N>::new(reflections.surfaces.len(), cuts.largest());
    cuts.set_reflection_ratios(|cluster, list| {
        let blockers = Blockers { list, table: &reflections.table, rule: tables.rule, own: OwnSpheres::default() };
        let (position, normal) = (cluster.place.map(f32x8::splat), cluster.normal.map(f32x8::splat));
        gather.see(&blockers, &radiating, &Receivers8 { position, normal, knows_own: f32x8::ZERO });
        gather.parts(&radiating, &normal)
    });
}
