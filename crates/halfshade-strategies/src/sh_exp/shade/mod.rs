//! Receivers in batches: eight side by side, those that see the same spheres one after another.

pub(crate) mod batches;

use super::{
    bake::Tables,
    prepare::{cuts::CutOf, frame::FrameData},
};
use batches::Batches;
use halfshade_scene::{RadianceMut, ReceiverBuffer, Receivers};
use halfshade_sh::dispatch_bands;
use halfshade_strategy::Prepared;

/// A frame ready to be shaded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shader<'a> {
    pub(crate) tables: &'a Tables,
    pub(crate) data: &'a FrameData,
}

impl Prepared for Shader<'_> {
    fn shade(&self, receivers: Receivers<'_>, out: RadianceMut<'_>) {
        self.shade_by(receivers, CutOf::Cluster, out);
    }
}

impl Shader<'_> {
    pub(crate) fn shade_by(&self, receivers: Receivers<'_>, whose: CutOf<'_>, out: RadianceMut<'_>) {
        // `bake` made sure that there is a kernel for this number of bands.
        let _: Option<()> = dispatch_bands!(self.tables.bands, N => shade::<N>(*self, receivers, whose, out));
    }
}

/// Shades all receivers. Each lane's result depends on its own receiver and its cut alone, so that batches may be split
/// anywhere; the last group of a cut is filled up with copies of its last receiver.
fn shade<const N: usize>(shader: Shader<'_>, receivers: Receivers<'_>, whose: CutOf<'_>, mut out: RadianceMut<'_>) {
    let cuts = &shader.data.cuts;
    let mut batches = Batches::<N>::new(shader.tables, shader.data);
    let Some(cut_of) = cuts.of(receivers, &shader.data.space, whose) else {
        if shader.data.ground.is_none() && shader.tables.own.is_none() {
            return batches.shade(receivers, cuts.cut(0), &mut out, |place| place);
        }
        let mut first = 0;
        for run in receivers.object.chunk_by(|a, b| a == b) {
            batches.shade(receivers.slice(first..first + run.len()), cuts.cut(0), &mut out, |place| first + place);
            first += run.len();
        }
        return;
    };
    let mut order: Vec<u32> = (0..receivers.len() as u32).collect();
    let group = |i: u32| (cut_of[i as usize], receivers.object[i as usize]);
    order.sort_by_key(|&i| group(i));
    for run in order.chunk_by(|&a, &b| group(a) == group(b)) {
        let cut = cuts.cut(cut_of[run[0] as usize] as usize);
        let gathered = ReceiverBuffer::gathered(receivers, run);
        batches.shade(gathered.view(), cut, &mut out, |place| run[place] as usize);
    }
}
