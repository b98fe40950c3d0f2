//! Declarations of the content of scene text. Types inside of [`declared!`] are written as anywhere else; the manual,
//! the JSON Schema, the readers and the command line have their comments and words from here.

/// Comments of a type and of its parts, of which the manual is made.
#[derive(Debug)]
pub struct TypeDoc {
    /// Name of the type.
    pub name: &'static str,
    /// Its own comment first, then comments of its variants and fields.
    pub comments: &'static [Comment],
}

/// Comment of a type, of a variant or of a field.
#[derive(Debug)]
pub struct Comment {
    /// Name of the variant that it is about, or that has the field.
    pub variant: Option<&'static str>,
    /// Name of the field.
    pub field: Option<&'static str>,
    /// Lines of the comment.
    pub lines: &'static [&'static str],
}

/// A type with comments for the manual.
pub trait Described {
    /// Comments of the type and of its parts.
    const DOC: &'static TypeDoc;
}

/// One of the words that a value may be.
#[derive(Debug)]
pub struct Word {
    /// The word in scene text, in tables and on the command line.
    pub name: &'static str,
    /// Lines of its comment.
    pub lines: &'static [&'static str],
    /// Its meaning in few words, for the help of the command line; empty for words that are no option.
    pub summary: &'static str,
}

/// A value that is one of a fixed set of words.
pub trait Words: Copy + PartialEq + 'static {
    /// All values.
    const EACH: &'static [Self];
    /// Word of each value.
    const WORDS: &'static [Word];
}

/// Declares an enum whose variants each have a word, perhaps with a summary: `Ssr = "ssr": "Screen space only"`.
#[macro_export]
macro_rules! words {
    (
        $(#[$attribute:meta])*
        pub enum $name:ident $(= $default:ident)? {
            $(
                $(#[doc = $text:literal])*
                $variant:ident = $word:literal $(: $summary:literal)?
            ),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $(
                #[doc = concat!("`\"", $word, "\"`:")]
                $(#[doc = $text])*
                $variant,
            )*
        }

        impl $name {
            /// All values, in the order of the manual.
            pub const ALL: [Self; [$($word),*].len()] = [$(Self::$variant),*];

            /// Word in texts, in tables and on the command line.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)*
                }
            }

            /// The value of a word.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|value| value.name() == name)
            }
        }

        $(
            impl Default for $name {
                fn default() -> Self {
                    Self::$default
                }
            }
        )?

        impl $crate::declared::Words for $name {
            const EACH: &'static [Self] = &Self::ALL;
            const WORDS: &'static [$crate::declared::Word] = &[
                $($crate::declared::Word {
                    name: $word,
                    lines: &[$($text),*],
                    summary: concat!($($summary)?),
                }),*
            ];
        }
    };
}

/// Declares types of scene text: structs and enums with their comments; with `#[defaults]`, structs whose fields may each
/// have a default, `face_px: u32 = 128`, in place of their type's; and with `#[words]`, enums of [`words!`].
macro_rules! declared {
    () => {};
    (
        $(#[doc = $doc:literal])*
        #[words]
        pub enum $name:ident $(= $default:ident)? { $($variants:tt)* }
        $($rest:tt)*
    ) => {
        words! {
            $(#[doc = $doc])*
            pub enum $name $(= $default)? { $($variants)* }
        }

        declared! { $($rest)* }
    };
    (
        $(#[doc = $doc:literal])*
        pub struct $name:ident;
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        pub struct $name;

        documented!($name $($doc)*;);
        declared! { $($rest)* }
    };
    (
        $(#[doc = $doc:literal])*
        #[derive($($derived:ident),*)]
        #[defaults]
        pub struct $name:ident {
            $($(#[doc = $text:literal])* pub $field:ident: $type:ty $(= $default:expr)?),* $(,)?
        }
        $($rest:tt)*
    ) => {
        impl Default for $name {
            fn default() -> Self {
                Self { $($field: default!($($default)?),)* }
            }
        }

        declared! {
            $(#[doc = $doc])*
            #[derive($($derived),*)]
            pub struct $name {
                $($(#[doc = $text])* pub $field: $type,)*
            }

            $($rest)*
        }
    };
    (
        $(#[doc = $doc:literal])*
        #[derive($($derived:ident),*)]
        pub struct $name:ident {
            $($(#[doc = $text:literal])* pub $field:ident: $type:ty),* $(,)?
        }
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        #[derive($($derived),*)]
        pub struct $name {
            $($(#[doc = $text])* pub $field: $type,)*
        }

        documented!($name $($doc)*; $((None, Some(stringify!($field))) $($text)*;)*);
        declared! { $($rest)* }
    };
    (
        $(#[doc = $doc:literal])*
        #[derive($($derived:ident),*)]
        pub enum $name:ident {
            $(
                $(#[doc = $text:literal])*
                $variant:ident
                $(($($inner:ty),*))?
                $({ $($(#[doc = $about:literal])* $field:ident: $type:ty),* $(,)? })?
            ),* $(,)?
        }
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        #[derive($($derived),*)]
        pub enum $name {
            $(
                $(#[doc = $text])*
                $variant
                $(($($inner),*))?
                $({ $($(#[doc = $about])* $field: $type),* })?,
            )*
        }

        documented!($name $($doc)*; $(
            (Some(stringify!($variant)), None) $($text)*;
            $($((Some(stringify!($variant)), Some(stringify!($field))) $($about)*;)*)?
        )*);
        declared! { $($rest)* }
    };
}

/// A default value, or the default of its type.
macro_rules! default {
    () => {
        Default::default()
    };
    ($value:expr) => {
        $value
    };
}

/// Gives a type its comments: its own, and its parts', each after its variant and field.
macro_rules! documented {
    ($name:ident $($doc:literal)*; $(($variant:expr, $field:expr) $($text:literal)*;)*) => {
        impl $crate::declared::Described for $name {
            const DOC: &'static $crate::declared::TypeDoc = &$crate::declared::TypeDoc {
                name: stringify!($name),
                comments: &[
                    $crate::declared::Comment { variant: None, field: None, lines: &[$($doc),*] },
                    $($crate::declared::Comment {
                        variant: $variant,
                        field: $field,
                        lines: &[$($text),*],
                    },)*
                ],
            };
        }
    };
}
