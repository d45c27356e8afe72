//! Accessors of numbers that belong to skins and animations.

use super::{Buffers, elements};
use crate::SceneError;
use ::gltf::Accessor;
use ::gltf::accessor::{DataType, Dimensions};

/// What whole numbers mean in an accessor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Whole {
    /// Themselves.
    Number,
    /// Fractions of their maximum, as glTF normalizes them: `x / max`, of signed ones at least -1.
    Fraction,
    /// They aren't allowed.
    Refused,
}

/// The elements of an accessor, of `N` numbers each and all finite; matrices column by column.
///
/// `N` is the number of components that `dimensions` has. Where whole numbers are themselves, others are refused.
pub(super) fn numbers<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &Buffers,
    dimensions: Dimensions,
    whole: Whole,
) -> Result<Vec<[f64; N]>, SceneError> {
    let index = accessor.index();
    let (kind, found) = (accessor.data_type(), accessor.dimensions());
    if found != dimensions || dimensions.multiplicity() != N {
        return Err(SceneError::new(format!("accessor {index} should hold {dimensions:?}, but holds {found:?}")));
    }
    let number: fn(&[u8]) -> f64 = match kind {
        DataType::F32 => |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        DataType::I8 => |b| f64::from(i8::from_le_bytes([b[0]])),
        DataType::U8 => |b| f64::from(b[0]),
        DataType::I16 => |b| f64::from(i16::from_le_bytes([b[0], b[1]])),
        DataType::U16 => |b| f64::from(u16::from_le_bytes([b[0], b[1]])),
        DataType::U32 => |b| f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
    };
    let largest = match (kind, whole) {
        (DataType::F32, Whole::Fraction | Whole::Refused) => 1.0,
        (DataType::U8 | DataType::U16, Whole::Number) => 1.0,
        (DataType::I8, Whole::Fraction) => f64::from(i8::MAX),
        (DataType::U8, Whole::Fraction) => f64::from(u8::MAX),
        (DataType::I16, Whole::Fraction) => f64::from(i16::MAX),
        (DataType::U16, Whole::Fraction) => f64::from(u16::MAX),
        _ => return Err(SceneError::new(format!("accessor {index} holds {kind:?}, which is not allowed here"))),
    };
    let lowest = if kind == DataType::F32 { f64::NEG_INFINITY } else { -1.0 };
    let width = kind.size();
    let read = |bytes: &[u8]| std::array::from_fn(|i| (number(&bytes[i * width..]) / largest).max(lowest));
    let list: Vec<[f64; N]> = elements(accessor, buffers)?.map(read).collect();
    match list.iter().position(|element| element.iter().any(|x| !x.is_finite())) {
        Some(place) => {
            Err(SceneError::new(format!("element {place} of accessor {index} holds a number that is not finite")))
        }
        None => Ok(list),
    }
}
