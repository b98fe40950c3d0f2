//! Declaration of structs that Rust and the shaders share, with their layout for tests.

/// Layout of a shared struct in Rust.
#[derive(Clone, Copy, Debug)]
pub struct StructSpec {
    /// Name of the WGSL struct.
    pub name: &'static str,
    /// Size in bytes.
    pub size: usize,
    /// Name, offset and size in bytes of each field, in order.
    pub fields: &'static [(&'static str, usize, usize)],
    /// Rust type of each field, in order.
    pub types: &'static [&'static str],
}

/// Declares a struct shared with the shaders: `repr(C)`, plain data, and its layout for the test.
macro_rules! gpu_struct {
    ($(#[$meta:meta])* $vis:vis struct $name:ident = $wgsl:literal {
        $($(#[$field_meta:meta])* $field:ident: $ty:ty,)*
    }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl $name {
            /// Layout that the shaders' declaration must have.
            pub const LAYOUT: $crate::layout::gpu_struct::StructSpec = $crate::layout::gpu_struct::StructSpec {
                name: $wgsl,
                size: size_of::<$name>(),
                fields: &[$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$ty>()),)*],
                types: &[$(stringify!($ty),)*],
            };
        }
    };
}
pub(crate) use gpu_struct;
