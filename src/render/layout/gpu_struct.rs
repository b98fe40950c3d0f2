//! Declaration of structs that Rust and the shaders share: written in Rust, with the text of the WGSL struct made from
//! it.

use std::fmt::Write as _;

/// A field of a shared struct.
#[derive(Clone, Copy, Debug)]
pub struct SharedField {
    /// Name in Rust and in the shaders.
    pub name: &'static str,
    /// Offset from the start of the struct, bytes.
    pub offset: usize,
    /// Size, bytes.
    pub size: usize,
    /// Its type in the shaders.
    pub wgsl: fn() -> String,
    /// The shared struct that it is an array of.
    pub listed: Option<&'static StructSpec>,
}

/// Layout of a shared struct.
#[derive(Clone, Copy, Debug)]
pub struct StructSpec {
    /// Name of the WGSL struct.
    pub name: &'static str,
    /// Size in the shaders, bytes: a multiple of the alignment.
    pub size: usize,
    /// Fields, in order; without the padding at the end.
    pub fields: &'static [SharedField],
}

impl StructSpec {
    /// Declaration of the struct in WGSL.
    pub fn wgsl(&self) -> String {
        let mut text = format!("struct {} {{\n", self.name);
        for field in self.fields {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "    {}: {},", field.name, (field.wgsl)());
        }
        text + "}\n"
    }
}

/// A Rust type whose values shaders read as they lie in memory.
pub trait Shared: Copy {
    /// Alignment in the shaders, bytes; in Rust it is 4.
    const ALIGN: usize;
    /// Zeros.
    const ZERO: Self;
    /// The shared struct that it is an array of.
    const LISTED: Option<&'static StructSpec> = None;
    /// Type in the shaders.
    fn wgsl() -> String;
}

/// A shared struct, which `gpu_struct!` declares.
pub trait SharedStruct: Shared + 'static {
    /// Its layout.
    const SPEC: &'static StructSpec;
}

impl<T: SharedStruct, const N: usize> Shared for [T; N] {
    const ALIGN: usize = T::ALIGN;
    const ZERO: Self = [T::ZERO; N];
    const LISTED: Option<&'static StructSpec> = {
        assert!(
            size_of::<T>() == T::SPEC.size,
            "shaders would expect padding between the elements of this array: declare its struct as `padded`"
        );
        Some(T::SPEC)
    };
    fn wgsl() -> String {
        format!("array<{}, {N}>", T::SPEC.name)
    }
}

macro_rules! shared {
    ($($ty:ty = $wgsl:literal, $align:literal, $zero:expr;)*) => {$(
        impl Shared for $ty {
            const ALIGN: usize = $align;
            const ZERO: Self = $zero;
            fn wgsl() -> String {
                $wgsl.to_owned()
            }
        }
    )*};
}

shared! {
    f32 = "f32", 4, 0.0;
    u32 = "u32", 4, 0;
    [f32; 2] = "vec2f", 8, [0.0; 2];
    [i32; 2] = "vec2i", 8, [0; 2];
    [f32; 3] = "vec3f", 16, [0.0; 3];
    [f32; 4] = "vec4f", 16, [0.0; 4];
    [[f32; 4]; 3] = "mat3x4f", 16, [[0.0; 4]; 3];
    [[f32; 4]; 4] = "mat4x4f", 16, [[0.0; 4]; 4];
    [[f32; 4]; 6] = "array<vec4f, 6>", 16, [[0.0; 4]; 6];
}

/// Largest of some alignments.
pub(crate) const fn largest(aligns: &[usize]) -> usize {
    let (mut largest, mut i) = (4, 0);
    while i < aligns.len() {
        if aligns[i] > largest {
            largest = aligns[i];
        }
        i += 1;
    }
    largest
}

/// Declares a struct shared with the shaders: `repr(C)`, plain data, and its layout. A struct of which shaders have
/// arrays is `padded`: `..Self::ZERO` stands for the padding.
macro_rules! gpu_struct {
    ($(#[$meta:meta])* $vis:vis struct $name:ident = $wgsl:literal {
        $($(#[$field_meta:meta])* $field:ident: $ty:ty,)*
    }) => {
        $crate::layout::gpu_struct::gpu_struct!(@declare {$(#[$meta])*} $vis $name $wgsl {
            $($(#[$field_meta])* $field: $ty,)*
        } {} {});
    };
    ($(#[$meta:meta])* $vis:vis struct $name:ident = padded $wgsl:literal {
        $($(#[$field_meta:meta])* $field:ident: $ty:ty,)*
    }) => {
        $crate::layout::gpu_struct::gpu_struct!(@declare {$(#[$meta])*} $vis $name $wgsl {
            $($(#[$field_meta])* $field: $ty,)*
        } {
            /// Unused: fills the struct up to a multiple of four numbers.
            pub padding: [u32; (4 - (0 $(+ size_of::<$ty>())*) / 4 % 4) % 4],
        } {
            padding: [0; _],
        });
    };
    (@declare {$(#[$meta:meta])*} $vis:vis $name:ident $wgsl:literal {
        $($(#[$field_meta:meta])* $field:ident: $ty:ty,)*
    } {$($padding:tt)*} {$($zero:tt)*}) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
            $($padding)*
        }

        impl $name {
            /// Layout, in Rust and in the shaders.
            pub const LAYOUT: $crate::layout::gpu_struct::StructSpec = {
                use $crate::layout::gpu_struct::{Shared, SharedField, StructSpec};
                $(
                    assert!(
                        std::mem::offset_of!($name, $field) % <$ty as Shared>::ALIGN == 0,
                        concat!("shaders expect padding before `", stringify!($field), "`: \
                            three numbers and a single one go together, and single ones come last")
                    );
                )*
                StructSpec {
                    name: $wgsl,
                    size: size_of::<Self>().next_multiple_of(<Self as Shared>::ALIGN),
                    fields: &[$(SharedField {
                        name: stringify!($field),
                        offset: std::mem::offset_of!($name, $field),
                        size: size_of::<$ty>(),
                        wgsl: <$ty as Shared>::wgsl,
                        listed: <$ty as Shared>::LISTED,
                    },)*],
                }
            };
        }

        impl $crate::layout::gpu_struct::Shared for $name {
            const ALIGN: usize = $crate::layout::gpu_struct::largest(
                &[$(<$ty as $crate::layout::gpu_struct::Shared>::ALIGN,)*],
            );
            const ZERO: Self = Self {
                $($field: <$ty as $crate::layout::gpu_struct::Shared>::ZERO,)*
                $($zero)*
            };
            fn wgsl() -> String {
                $wgsl.to_owned()
            }
        }

        impl $crate::layout::gpu_struct::SharedStruct for $name {
            const SPEC: &'static $crate::layout::gpu_struct::StructSpec = &Self::LAYOUT;
        }
    };
}
pub(crate) use gpu_struct;
