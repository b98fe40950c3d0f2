//! Comments and words of the content of scene text, for the manual, the JSON Schema, the readers and the command line.

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
    /// Group of keys that begins or goes on with the field; empty where no group is named.
    pub group: &'static str,
    /// Lines of the comment.
    pub lines: &'static [&'static str],
}

impl TypeDoc {
    /// Groups of fields in the order of the manual; the first, without a name, has what belongs to no group.
    pub fn groups(&self) -> Vec<&'static str> {
        let mut groups = vec![""];
        for comment in self.comments {
            if !groups.contains(&comment.group) {
                groups.push(comment.group);
            }
        }
        groups
    }

    /// Group of a field: the last group that is named before or at it; empty for no group.
    pub fn group_of(&self, field: &str) -> &'static str {
        let is_it = |comment: &Comment| comment.field == Some(field);
        let until = self.comments.iter().position(is_it).map_or(0, |at| at + 1);
        let mut named = self.comments[..until].iter().rev();
        named
            .find_map(|comment| (!comment.group.is_empty()).then_some(comment.group))
            .unwrap_or_default()
    }
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
