//! Accessors: lists of numbers in the buffers of a document.

use super::Buffers;
use crate::SceneError;
use ::gltf::Accessor;
use ::gltf::accessor::sparse::IndexType;
use ::gltf::accessor::{DataType, Dimensions};
use glam::DVec3;
use std::collections::BTreeMap;

/// Most elements of an accessor that has no data of its own and is all zero, but for what a sparse list replaces.
const MOST_ZEROS: usize = 1 << 24;

/// Meaning of whole numbers in an accessor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum WholeNumbers {
    /// Themselves.
    Number,
    /// Fractions of their maximum, as glTF normalizes them: `x / max`, of signed ones at least -1.
    Fraction,
    /// Either, as the accessor says.
    AsDeclared,
    /// They aren't allowed.
    Refused,
}

/// The elements of an accessor, of `N` numbers each and all finite; matrices column by column.
///
/// `N` is the number of components that `dimensions` has.
pub(super) fn numbers<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &Buffers,
    dimensions: Dimensions,
    whole: WholeNumbers,
) -> Result<Vec<[f64; N]>, SceneError> {
    let list = any_numbers(accessor, buffers, dimensions, whole)?;
    match list.iter().position(|element: &[f64; N]| element.iter().any(|x| !x.is_finite())) {
        Some(place) => {
            let index = accessor.index();
            Err(SceneError::new(format!("element {place} of accessor {index} holds a number that is not finite"))
                .with_remedy("repair the mesh in the program that wrote it"))
        }
        None => Ok(list),
    }
}

/// Like [`numbers`], finite or not.
pub(super) fn any_numbers<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &Buffers,
    dimensions: Dimensions,
    whole: WholeNumbers,
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
    let is_fraction = whole == WholeNumbers::Fraction || whole == WholeNumbers::AsDeclared && accessor.normalized();
    let largest = match (kind, whole) {
        (DataType::F32, WholeNumbers::Fraction | WholeNumbers::Refused | WholeNumbers::AsDeclared) => 1.0,
        (DataType::U8 | DataType::U16, WholeNumbers::Number) => 1.0,
        (DataType::U32, _) | (_, WholeNumbers::Refused | WholeNumbers::Number) => {
            return Err(SceneError::new(format!("accessor {index} holds {kind:?}, which is not allowed here")));
        }
        (DataType::I8, _) if is_fraction => f64::from(i8::MAX),
        (DataType::U8, _) if is_fraction => f64::from(u8::MAX),
        (DataType::I16, _) if is_fraction => f64::from(i16::MAX),
        (DataType::U16, _) if is_fraction => f64::from(u16::MAX),
        _ => 1.0,
    };
    let lowest = if is_fraction && kind != DataType::F32 { -1.0 } else { f64::NEG_INFINITY };
    let width = kind.size();
    // A maximum would turn what isn't a number into one.
    let scaled = |x: f64| if x < lowest { lowest } else { x };
    let read = |bytes: &[u8]| std::array::from_fn(|i| scaled(number(&bytes[i * width..]) / largest));
    Ok(elements(accessor, buffers)?.map(read).collect())
}

/// An accessor of vertex indices.
pub(super) fn indices(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<u32>, SceneError> {
    let index: fn(&[u8]) -> u32 = match (accessor.data_type(), accessor.dimensions()) {
        (DataType::U8, Dimensions::Scalar) => |b| b[0].into(),
        (DataType::U16, Dimensions::Scalar) => |b| u16::from_le_bytes([b[0], b[1]]).into(),
        (DataType::U32, Dimensions::Scalar) => |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        (kind, found) => {
            let index = accessor.index();
            let problem = format!("accessor {index} holds {found:?} of {kind:?}, which vertex indices can't be");
            return Err(SceneError::new(problem));
        }
    };
    Ok(elements(accessor, buffers)?.map(index).collect())
}

/// Bytes of each element of an accessor, and nothing outside of its buffer.
fn elements<'a>(accessor: &Accessor<'_>, buffers: &'a Buffers) -> Result<impl Iterator<Item = &'a [u8]>, SceneError> {
    // The largest element is a matrix of 16 numbers.
    static ZEROS: [u8; 64] = [0; 64];
    let (index, size, count) = (accessor.index(), accessor.size(), accessor.count());
    let beyond = || {
        SceneError::new(format!("accessor {index} reaches beyond its buffer"))
            .with_remedy("the file was cut short or damaged: get it again")
    };
    let replaced = replaced(accessor, buffers)?.ok_or_else(beyond)?;
    let (data, stride) = match accessor.view().filter(|_| !buffers.is_zero(index)) {
        Some(view) => {
            let stride = view.stride().unwrap_or(size).max(1);
            let data = buffers.view(&view).and_then(|data| data.get(accessor.offset()..)).ok_or_else(beyond)?;
            let needed = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size));
            if needed.is_none_or(|needed| needed > data.len()) {
                return Err(beyond());
            }
            (data, stride)
        }
        None if count > MOST_ZEROS => {
            let problem = format!("accessor {index} has no data, yet {count} elements: at most {MOST_ZEROS} are read");
            return Err(SceneError::new(problem));
        }
        None => (&ZEROS[..], 0),
    };
    if let Some((last, _)) = replaced.last_key_value().filter(|(last, _)| **last >= count) {
        return Err(SceneError::new(format!("accessor {index} replaces element {last}, but has only {count}")));
    }
    Ok((0..count).map(move |i| match replaced.get(&i) {
        Some(bytes) => bytes,
        None => &data[i * stride..i * stride + size],
    }))
}

/// The elements that a sparse accessor replaces; `None` where they lie beyond a buffer.
fn replaced<'a>(
    accessor: &Accessor<'_>,
    buffers: &'a Buffers,
) -> Result<Option<BTreeMap<usize, &'a [u8]>>, SceneError> {
    let Some(sparse) = accessor.sparse() else { return Ok(Some(BTreeMap::new())) };
    let (places, values, count, size) = (sparse.indices(), sparse.values(), sparse.count(), accessor.size());
    let (width, number): (usize, fn(&[u8]) -> usize) = match places.index_type() {
        IndexType::U8 => (1, |b| b[0].into()),
        IndexType::U16 => (2, |b| u16::from_le_bytes([b[0], b[1]]).into()),
        IndexType::U32 => (4, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize),
    };
    let part = |view: &::gltf::buffer::View<'_>, offset: usize, size: usize| {
        buffers.view(view)?.get(offset..)?.get(..count.checked_mul(size)?)
    };
    let (Some(at), Some(of)) =
        (part(&places.view(), places.offset(), width), part(&values.view(), values.offset(), size))
    else {
        return Ok(None);
    };
    let replaced: BTreeMap<usize, &[u8]> = at.chunks_exact(width).map(number).zip(of.chunks_exact(size)).collect();
    if replaced.len() < count {
        let index = accessor.index();
        return Err(SceneError::new(format!("accessor {index} replaces an element twice")));
    }
    Ok(Some(replaced))
}

/// An accessor of positions or of shifts of them.
pub(super) fn vectors(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<DVec3>, SceneError> {
    let list = numbers::<3>(accessor, buffers, Dimensions::Vec3, WholeNumbers::AsDeclared)?;
    Ok(list.into_iter().map(DVec3::from).collect())
}

/// A list of as many elements as there are positions.
pub(super) fn of_count<T>(list: Vec<T>, count: usize) -> Result<Vec<T>, SceneError> {
    if list.len() == count {
        return Ok(list);
    }
    Err(SceneError::new(format!("{} elements for {count} positions", list.len()))
        .with_remedy("the file was written wrongly: export it again"))
}
