//! Typed arrays out of checked accessors: floats, normalized integers, indices, sparse elements.

use super::{
    Fault,
    accessor::{Component, Data, Layout, fault, shape},
    schema::Accessor,
};

impl Data<'_> {
    /// Takes bytes from the budget.
    pub(super) fn spend(&self, bytes: u64) -> Result<(), Fault> {
        self.budget.take(bytes)
    }

    /// Elements of an accessor as floats; normalized integers become 0 to 1 or −1 to 1.
    /// `accept` says which component types (and whether normalized) the use allows.
    pub fn floats<const N: usize>(
        &self,
        index: usize,
        accept: fn(Component, bool) -> bool,
    ) -> Result<Vec<[f32; N]>, Fault> {
        self.floats_at(index, accept, None)
    }

    /// Same as [`Data::floats`] for the elements `rows`, each below the accessor's count; `None` reads all.
    pub fn floats_at<const N: usize>(
        &self,
        index: usize,
        accept: fn(Component, bool) -> bool,
        rows: Option<&[u32]>,
    ) -> Result<Vec<[f32; N]>, Fault> {
        let layout = self.layout(index)?;
        let accessor = self.accessor(index)?;
        if layout.lanes != N || !accept(layout.component, accessor.normalized) {
            return Err(fault(format!(
                "accessor {index} is {}{} {:?}, which is not allowed here",
                if accessor.normalized {
                    "normalized "
                } else {
                    ""
                },
                accessor.kind,
                layout.component
            )));
        }
        // With sparse elements all elements are read first, then the rows are picked.
        let gathered = rows.filter(|_| accessor.sparse.is_none());
        let count = gathered.map_or(layout.count, <[u32]>::len);
        self.spend(count as u64 * (N as u64 * 4))?;
        let convert = |bytes: &[u8], layout: &Layout, rows: Option<&[u32]>| match (
            layout.component,
            accessor.normalized,
        ) {
            (Component::F32, _) => gather::<4, N>(bytes, layout, rows, f32::from_le_bytes),
            (Component::U32, _) => {
                gather::<4, N>(bytes, layout, rows, |b| u32::from_le_bytes(b) as f32)
            }
            (Component::I8, false) => {
                gather::<1, N>(bytes, layout, rows, |b| f32::from(b[0] as i8))
            }
            (Component::U8, false) => gather::<1, N>(bytes, layout, rows, |b| f32::from(b[0])),
            (Component::I16, false) => {
                gather::<2, N>(bytes, layout, rows, |b| f32::from(i16::from_le_bytes(b)))
            }
            (Component::U16, false) => {
                gather::<2, N>(bytes, layout, rows, |b| f32::from(u16::from_le_bytes(b)))
            }
            // glTF 2.0 §3.6.2.2, the formulas for normalized integers.
            (Component::I8, true) => gather::<1, N>(bytes, layout, rows, |b| {
                (f32::from(b[0] as i8) / 127.0).max(-1.0)
            }),
            (Component::U8, true) => {
                gather::<1, N>(bytes, layout, rows, |b| f32::from(b[0]) / 255.0)
            }
            (Component::I16, true) => gather::<2, N>(bytes, layout, rows, |b| {
                (f32::from(i16::from_le_bytes(b)) / 32767.0).max(-1.0)
            }),
            (Component::U16, true) => gather::<2, N>(bytes, layout, rows, |b| {
                f32::from(u16::from_le_bytes(b)) / 65535.0
            }),
        };
        let all = self.assemble(accessor, &layout, [0.0; N], convert, gathered);
        let all = all.map_err(|f| f.placed(&format!("accessor {index}")))?;
        Ok(match rows.filter(|_| gathered.is_none()) {
            Some(rows) => rows.iter().map(|&row| all[row as usize]).collect(),
            None => all,
        })
    }

    /// Elements of a scalar accessor of unsigned integers.
    pub fn indices(&self, index: usize) -> Result<Vec<u32>, Fault> {
        let layout = self.layout(index)?;
        let accessor = self.accessor(index)?;
        let unsigned = matches!(
            layout.component,
            Component::U8 | Component::U16 | Component::U32
        );
        if layout.lanes != 1 || !unsigned || accessor.normalized {
            let text = format!(
                "accessor {index} is {} {:?}, expected unsigned SCALAR indices",
                accessor.kind, layout.component
            );
            return Err(fault(text));
        }
        self.spend(layout.count as u64 * 4)?;
        let convert =
            |bytes: &[u8], layout: &Layout, _: Option<&[u32]>| gather_unsigned(bytes, layout);
        self.assemble(accessor, &layout, [0; 1], convert, None)
            .map(|v| v.into_iter().map(|[i]| i).collect())
            .map_err(|f| f.placed(&format!("accessor {index}")))
    }

    /// Base elements (zeros without a view), overwritten by the sparse ones. `rows` may be given only for accessors
    /// without sparse elements.
    fn assemble<T: Copy>(
        &self,
        accessor: &Accessor,
        layout: &Layout,
        zero: T,
        convert: impl Fn(&[u8], &Layout, Option<&[u32]>) -> Vec<T>,
        rows: Option<&[u32]>,
    ) -> Result<Vec<T>, Fault> {
        let mut out = match accessor.buffer_view {
            Some(view) => convert(&self.view_start(view, layout.end)?, layout, rows),
            None => vec![zero; rows.map_or(layout.count, <[u32]>::len)],
        };
        let Some(sparse) = &accessor.sparse else {
            return Ok(out);
        };
        let count = sparse.count as usize; // at most accessor.count, which fits
        let part = |component: Component, offset: u64, stride| Layout {
            component,
            lanes: layout.lanes,
            count,
            offset: offset as usize, // inside its view, as check_sparse found
            stride,
            ..*layout
        };
        let (indices, values) = (&sparse.indices, &sparse.values);
        let index_type = Component::new(indices.component_type).unwrap_or(Component::U8);
        let index_layout = part(index_type, indices.byte_offset, index_type.size());
        let targets = gather_unsigned(&self.view_bytes(indices.buffer_view)?, &index_layout);
        let size = layout.component.size();
        let element = shape(&accessor.kind, size).map_or(size, |s| s.pitch);
        let value_layout = part(layout.component, values.byte_offset, element);
        let values = convert(&self.view_bytes(values.buffer_view)?, &value_layout, None);
        let mut previous = None;
        for ([target], value) in targets.into_iter().zip(values) {
            let slot = out.get_mut(target as usize);
            let slot = slot
                .filter(|_| previous.is_none_or(|p| p < target))
                .ok_or_else(|| {
                    fault(format!(
                        "sparse index {target} is out of range or out of order"
                    ))
                })?;
            *slot = value;
            previous = Some(target);
        }
        Ok(out)
    }
}

/// Reads `N`-vectors of `SIZE`-byte components, of all rows or of `rows`; the layout was checked against the view's
/// length.
fn gather<const SIZE: usize, const N: usize>(
    bytes: &[u8],
    layout: &Layout,
    rows: Option<&[u32]>,
    convert: impl Fn([u8; SIZE]) -> f32,
) -> Vec<[f32; N]> {
    let element = |i: usize| {
        std::array::from_fn(|lane| {
            let start = layout.offset + i * layout.stride + lane * SIZE;
            let component = bytes
                .get(start..start + SIZE)
                .and_then(|b| b.try_into().ok());
            component.map_or(0.0, &convert)
        })
    };
    match rows {
        Some(rows) => rows.iter().map(|&row| element(row as usize)).collect(),
        None => (0..layout.count).map(element).collect(),
    }
}

fn gather_unsigned(bytes: &[u8], layout: &Layout) -> Vec<[u32; 1]> {
    let size = layout.component.size();
    let element = |i: usize| {
        let start = layout.offset + i * layout.stride;
        let component = bytes.get(start..start + size).unwrap_or_default();
        [component
            .iter()
            .rev()
            .fold(0, |value, &b| value << 8 | u32::from(b))]
    };
    (0..layout.count).map(element).collect()
}
