//! Result of decoding a file, and checks that every decoder makes.

use crate::SceneError;
use glam::{DMat3, Vec3};

/// The largest width or height read: 16k by 8k is the largest probe in circulation.
const LARGEST_SIDE: usize = 16384;

/// Texels that a byte of a file may stand for. Constant images shrink about a thousandfold; what claims to be larger than
/// this was cut short. With 12 bytes a texel, it bounds the memory that a lying header can ask for.
pub(super) const TEXELS_PER_BYTE: usize = 4096;

/// Linear RGB, row by row from the top. Values as stored, unchecked.
#[derive(Debug, Clone)]
pub(in crate::light) struct Image {
    pub(in crate::light) width: usize,
    pub(in crate::light) height: usize,
    pub(in crate::light) texels: Vec<Vec3>,
}

/// Contents of a file.
#[derive(Debug)]
pub(in crate::light) struct Decoded {
    pub(in crate::light) image: Image,
    /// From the file's primaries to Rec. 709; `None` where they are those.
    pub(in crate::light) to_rec709: Option<DMat3>,
    /// Notes for the user.
    pub(in crate::light) notes: Vec<String>,
}

/// Refuses sizes that no file of this length holds, before memory is asked for.
pub(super) fn check_size(width: usize, height: usize, bytes: usize) -> Result<(), SceneError> {
    if width == 0 || height == 0 {
        return Err(SceneError::new(format!("the image is empty: {width}x{height}")));
    }
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(SceneError::new(format!("the image is {width}x{height}; at most {LARGEST_SIDE} are read"))
            .with_remedy("reduce it: 2048x1024 resolves all but a sun"));
    }
    if width * height / TEXELS_PER_BYTE > bytes {
        let problem = format!("the image claims to be {width}x{height}, too much for {bytes} bytes");
        return Err(SceneError::new(problem).with_remedy("the file was cut short or damaged: get it again"));
    }
    Ok(())
}

/// The error of a file that ends before its picture does.
pub(super) fn cut_short() -> SceneError {
    SceneError::new("the file ends before its picture does").with_remedy("it was cut short: get it again")
}
