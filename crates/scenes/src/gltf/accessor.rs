//! Accessors: numbers in buffers, looked up one record at a time.

use super::{data::Buffers, flaw, item, valid};
use crate::error::Flaw;
use gltf_json::{
    Root,
    accessor::{ComponentType, GenericComponentType, IndexComponentType, Type},
};

/// The records of an accessor; all of them lie within their buffers.
pub(super) struct Accessor<'d> {
    /// How many there are.
    pub(super) count: usize,
    records: Records<'d>,
    sparse: Option<Sparse<'d>>,
    component: ComponentType,
    /// Numbers that a record has.
    pub(super) components: usize,
    normalized: bool,
}

/// Records one after another.
struct Records<'d> {
    bytes: &'d [u8],
    stride: usize,
}

/// Records that stand in for others.
struct Sparse<'d> {
    /// Which they stand in for, rising.
    indices: Vec<u32>,
    values: Records<'d>,
}

impl<'d> Records<'d> {
    /// `count` records of `size` bytes from `offset` on, if there is room for them.
    fn of(bytes: &'d [u8], offset: u64, count: u64, size: usize, stride: Option<usize>) -> Option<Records<'d>> {
        let stride = stride.filter(|s| *s > 0).unwrap_or(size);
        let length = match count {
            0 => 0,
            n => (n - 1).checked_mul(stride as u64)?.checked_add(size as u64)?,
        };
        let end = offset.checked_add(length).filter(|end| *end <= bytes.len() as u64)?;
        Some(Records { bytes: &bytes[offset as usize..end as usize], stride })
    }

    fn record(&self, index: usize) -> &'d [u8] {
        &self.bytes[index * self.stride..]
    }
}

/// The number at a place in a record.
fn number(record: &[u8], component: ComponentType, place: usize) -> f64 {
    let at = &record[place * component.size()..];
    fn bytes<const N: usize>(at: &[u8]) -> [u8; N] {
        std::array::from_fn(|i| at[i])
    }
    match component {
        ComponentType::I8 => f64::from(i8::from_le_bytes(bytes(at))),
        ComponentType::U8 => f64::from(at[0]),
        ComponentType::I16 => f64::from(i16::from_le_bytes(bytes(at))),
        ComponentType::U16 => f64::from(u16::from_le_bytes(bytes(at))),
        ComponentType::U32 => f64::from(u32::from_le_bytes(bytes(at))),
        ComponentType::F32 => f64::from(f32::from_le_bytes(bytes(at))),
    }
}

impl<'d> Accessor<'d> {
    /// Opens an accessor of records of vectors or scalars.
    pub(super) fn open(root: &Root, buffers: &'d Buffers, index: usize) -> Result<Accessor<'d>, Flaw> {
        let accessor = item(&root.accessors, "accessors", index)?;
        let wrong = |what: &str| flaw(format!("accessors[{index}]: {what}"));
        let GenericComponentType(component) = valid(&accessor.component_type, || format!("accessors[{index}]"))?;
        let components = match valid(&accessor.type_, || format!("accessors[{index}]"))? {
            Type::Scalar => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            Type::Mat2 | Type::Mat3 | Type::Mat4 => return Err(wrong("matrices have no use here")),
        };
        let size = components * component.size();
        let count = accessor.count.0;
        if count > u64::from(u32::MAX) {
            return Err(wrong("it has more records than 32 bits can count"));
        }
        let view = accessor.buffer_view.ok_or_else(|| wrong("one without a buffer view is not supported"))?;
        let (bytes, stride) = buffers.view(root, view.value())?;
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let beyond = || wrong("it reaches beyond its buffer view's end");
        let records = Records::of(bytes, offset, count, size, stride).ok_or_else(beyond)?;
        let sparse = match &accessor.sparse {
            None => None,
            Some(sparse) => {
                let (indices, values) = (&sparse.indices, &sparse.values);
                let IndexComponentType(kind) =
                    valid(&indices.component_type, || format!("accessors[{index}].sparse.indices"))?;
                let (bytes, _) = buffers.view(root, indices.buffer_view.value())?;
                let places = Records::of(bytes, indices.byte_offset.0, sparse.count.0, kind.size(), None);
                let places = places.ok_or_else(beyond)?;
                let (bytes, _) = buffers.view(root, values.buffer_view.value())?;
                let values = Records::of(bytes, values.byte_offset.0, sparse.count.0, size, None).ok_or_else(beyond)?;
                let indices: Vec<u32> =
                    (0..sparse.count.0 as usize).map(|i| number(places.record(i), kind, 0) as u32).collect();
                if !indices.is_sorted_by(|a, b| a < b) || indices.last().is_some_and(|i| u64::from(*i) >= count) {
                    return Err(wrong("its sparse indices do not rise or lead beyond its end"));
                }
                Some(Sparse { indices, values })
            }
        };
        Ok(Accessor { count: count as usize, records, sparse, component, components, normalized: accessor.normalized })
    }

    fn record(&self, index: usize) -> &'d [u8] {
        let replaced = self.sparse.as_ref().and_then(|s| Some((s, s.indices.binary_search(&(index as u32)).ok()?)));
        match replaced {
            Some((sparse, at)) => sparse.values.record(at),
            None => self.records.record(index),
        }
    }

    /// The first `N` numbers of a record, `index` below the count and `N` at most the numbers it has; whole numbers that are
    /// normalised as from 0 or -1 to 1 [glTF 2.0, sec. 3.11].
    pub(super) fn vector<const N: usize>(&self, index: usize) -> [f32; N] {
        let record = self.record(index);
        let most = match self.component {
            _ if !self.normalized => 1.0,
            ComponentType::I8 => 127.0,
            ComponentType::U8 => 255.0,
            ComponentType::I16 => 32767.0,
            ComponentType::U16 => 65535.0,
            ComponentType::U32 => f64::from(u32::MAX),
            ComponentType::F32 => 1.0,
        };
        std::array::from_fn(|i| {
            let value = number(record, self.component, i) / most;
            // The lowest whole number stands for -1, too.
            if self.normalized && most > 1.0 { value.max(-1.0) as f32 } else { value as f32 }
        })
    }

    /// The whole number of a record, `index` below the count; none if it is not one.
    pub(super) fn whole(&self, index: usize) -> Option<u32> {
        match self.component {
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32 if self.components == 1 => {
                Some(number(self.record(index), self.component, 0) as u32)
            }
            _ => None,
        }
    }
}
