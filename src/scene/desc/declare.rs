//! Declarations of the tables of scene text: each key once, with its comment, type, range and default.

/// Declares types of scene text, with their comments for the manual. A field may say how scene text writes it: its form
/// there, whose content the field has, the range of its numbers, and its value where it is left out; without that, an
/// `Option` may be left out, and any other value must be there: `pub color: Vec3 as Color [FROM_0] = Vec3::ONE`. Before
/// it may stand, in this order:
///
/// - `#[by(function)]`: reads the key by a function of the table, which returns `None` where a required key is missing
///   or wrong. A closure knows the fields before it, as an `Option` each.
/// - `#[track(Number, "opacity")]`: form of its tracks, and their quantity in the manual; perhaps a function that gives
///   its value where it is left out.
///
/// After `#[derive(…)]` stands what is made of the fields:
///
/// - `#[defaults]`: an `impl Default`.
/// - `#[keys]`: an `impl Keys`. `#[table("[heading]")]`: an `impl Section` too. After the heading perhaps, in this order:
///   `also(TYPES)` whose comments tell of further keys; `refers(key: "kind")` for keys whose text names entries, and
///   `files(key: "extension")` for files; `before(function)` that declares rules, or keys that no field
///   has; `check(function)` that refuses values which do not go together; `then(function)` that changes them;
///   `instead(function)` that advises where the value is no table.
/// - `#[kinds]`, of an enum whose variants are chosen by `kind`: an `impl Keys`, perhaps with a function that refuses
///   values which do not go together; `#[table("[heading]")]` after it.
/// - `#[tracks(NAME)]`: a static table of the fields that may change over time.
///
/// With `#[words]`, enums are declared by [`words!`].
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
        pub struct $name:ident $(($visible:vis $inner:ty))?;
        $($rest:tt)*
    ) => {
        $(#[doc = $doc])*
        pub struct $name $(($visible $inner))?;

        documented!($name $($doc)*;);
        declared! { $($rest)* }
    };
    (
        $(#[doc = $doc:literal])*
        #[derive($($derived:ident),*)]
        #[kinds $(($check:expr))?]
        $(#[table($($how:tt)*)])?
        pub enum $name:ident {
            $(
                $(#[doc = $text:literal])*
                $variant:ident = $word:literal {
                    $(
                        $(#[doc = $about:literal])*
                        $(#[by($by:expr)])?
                        $field:ident: $type:ty $(as $form:ident)? $([$range:expr])? $(= $default:expr)?
                    ),* $(,)?
                }
            ),* $(,)?
        }
        $($rest:tt)*
    ) => {
        declared! {
            $(#[doc = $doc])*
            #[derive($($derived),*)]
            pub enum $name {
                $($(#[doc = $text])* $variant { $($(#[doc = $about])* $field: $type),* }),*
            }
        }

        impl $name {
            /// Word of each `kind` in scene text.
            pub const NAMES: [&'static str; [$($word),*].len()] = [$($word),*];

            const CHECK: fn(&Self, &mut $crate::table::Table) = or!([$($check)?] |_, _| {});

            /// Word of the `kind` in scene text.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant { .. } => $word,)*
                }
            }
        }

        impl $crate::table::Keys for $name {
            fn read_keys(t: &mut $crate::table::Table) -> Option<Self> {
                t.choose("kind", &[$(($word, |t| {
                    $(let $field = read_key!(
                        t stringify!($field), [$type]; [$($range)?] [$($form)?] [$($by)?] [$($default)?]
                    );)*
                    let it = Self::$variant { $($field: $field?),* };
                    $crate::table::check(t, &it, Self::CHECK);
                    Some(it)
                })),*])
            }
        }

        $(section! { $name ($($how)*) })?
        declared! { $($rest)* }
    };
    (
        $(#[doc = $doc:literal])*
        #[derive($($derived:ident),*)]
        $(#[$made:ident $(($($of:tt)*))?])*
        pub struct $name:ident $fields:tt
        $($rest:tt)*
    ) => {
        made_of_fields! { plain([$($doc)*] $($derived)*) $name $fields }
        $(made_of_fields! { $made($($($of)*)?) $name $fields })*
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

/// Makes a part of the declaration of a struct: the type, its defaults, its reader or its table of tracks. Each field
/// becomes an entry: its comment, name and type, then what stands before and after it, in brackets.
macro_rules! made_of_fields {
    (
        $made:ident $of:tt $name:ident {
            $(
                $(#[doc = $text:literal])*
                $(#[by($by:expr)])?
                $(#[track($($track:tt)*)])?
                pub $field:ident: $type:ty $(as $form:ident)? $([$range:expr])? $(= $default:expr)?
            ),* $(,)?
        }
    ) => {
        made_of_entries! { $made $of $name $(
            [$($text)*] $field [$type] [$($range)?] [$($form)?] [$($by)?] [$($($track)*)?] [$($default)?];
        )* }
    };
}

/// Makes a part of the declaration of a struct from the entries of its fields.
macro_rules! made_of_entries {
    (
        plain([$($doc:literal)*] $($derived:ident)*) $name:ident
        $([$($text:literal)*] $field:ident [$type:ty] $range:tt $form:tt $by:tt $track:tt $default:tt;)*
    ) => {
        $(#[doc = $doc])*
        #[derive($($derived),*)]
        pub struct $name {
            $($(#[doc = $text])* pub $field: $type,)*
        }

        documented!($name $($doc)*; $((None, Some(stringify!($field))) $($text)*;)*);
    };
    (
        defaults() $name:ident
        $($text:tt $field:ident $type:tt $range:tt $form:tt $by:tt $track:tt $default:tt;)*
    ) => {
        impl Default for $name {
            fn default() -> Self {
                Self { $($field: or!($default Default::default()),)* }
            }
        }
    };
    (
        keys() $name:ident
        $($text:tt $field:ident $type:tt $range:tt $form:tt $by:tt $track:tt $default:tt;)*
    ) => {
        impl $crate::table::Keys for $name {
            fn read_keys(t: &mut $crate::table::Table) -> Option<Self> {
                $(let $field = read_key!(t stringify!($field), $type; $range $form $by $default);)*
                Some(Self { $($field: $field?),* })
            }
        }
    };
    (table $how:tt $name:ident $($entries:tt)*) => {
        made_of_entries! { keys() $name $($entries)* }
        section! { $name $how }
    };
    (
        tracks($table:ident) $name:ident
        $(
            $text:tt $field:ident $type:tt $range:tt $form:tt $by:tt
            [$($lanes:ident, $what:literal $(, $value:expr)?)?] $default:tt;
        )*
    ) => {
        /// Values that tracks and scripts may change.
        pub static $table: [$crate::number::Field<$name>; [$($($what,)?)*].len()] = [$($(
            $crate::number::Field {
                key: stringify!($field),
                what: $what,
                form: $crate::number::Form::$lanes,
                range: or!($range $crate::range::ANY),
                get: or!([$($value)?] |it| $crate::number::Changing::value(&it.$field)),
                put: |it, value| $crate::number::Changing::put(&mut it.$field, value),
            },
        )?)*];
    };
}

/// Makes the reader of a table of scene text from the reader of its keys.
macro_rules! section {
    (
        $name:ident (
            $heading:literal
            $(, also($($also:ty),+))?
            $(, refers($($key:ident: $($kind:literal)|+),+))?
            $(, files($($file:ident: $($end:literal)|+),+))?
            $(, before($before:expr))?
            $(, check($check:expr))?
            $(, then($then:expr))?
            $(, instead($instead:expr))?
        )
    ) => {
        impl $crate::table::Section for $name {
            $(const ALSO: &'static [&'static $crate::declared::TypeDoc] =
                &[$(<$also as $crate::declared::Described>::DOC),+];)?
            const HEADING: &'static str = $heading;

            fn read(t: &mut $crate::table::Table) -> Option<Self> {
                $($crate::table::before(t, $before);)?
                let it = $crate::table::Keys::read_keys(t);
                $($(t.refers(stringify!($key), &[$($kind),+]);)+)?
                $($(t.files(stringify!($file), &[$($end),+]);)+)?
                let it = it?;
                $($crate::table::check(t, &it, $check);)?
                $(let it = $crate::table::then(t, it, $then);)?
                Some(it)
            }

            $(fn instead(key: &str, value: &$crate::syntax::Node) -> Option<String> {
                $crate::table::instead(key, value, $instead)
            })?
        }

        impl $crate::table::Key for Option<$name> {
            fn read(
                t: &mut $crate::table::Table,
                key: &'static str,
                _: $crate::range::Range,
            ) -> Option<Self> {
                Some(t.table(key))
            }
        }
    };
}

/// Reads a key as the entry of its field says, to an `Option` of the field's type.
macro_rules! read_key {
    ($t:ident $key:expr, [$type:ty]; $range:tt [] [] []) => {
        <$type as $crate::table::Key>::read($t, $key, or!($range $crate::range::ANY))
    };
    ($t:ident $key:expr, [$type:ty]; $range:tt [] [] [$default:expr]) => {
        Some($t.get::<$type>($key, or!($range $crate::range::ANY), $default))
    };
    ($t:ident $key:expr, [$type:ty]; $range:tt [$form:ident] [] []) => {
        $t.need($key, or!($range $crate::range::ANY)).map(|$form(value)| value)
    };
    ($t:ident $key:expr, [$type:ty]; $range:tt [$form:ident] [] [$default:expr]) => {
        Some($t.get($key, or!($range $crate::range::ANY), $form($default)).0)
    };
    ($t:ident $key:expr, [$type:ty]; $range:tt [] [$by:expr] $default:tt) => {
        $crate::table::read_by::<$type>($t, $by)
    };
}

/// A value, or another one where there is none.
macro_rules! or {
    ([] $other:expr) => {
        $other
    };
    ([$value:expr] $other:expr) => {
        $value
    };
}

/// Gives a type its comments: its own, and its parts', each after its variant and field.
macro_rules! documented {
    ($name:ident $($doc:literal)*; $(($variant:expr, $field:expr $(, in $group:literal)?) $($text:literal)*;)*) => {
        impl $crate::declared::Described for $name {
            const DOC: &'static $crate::declared::TypeDoc = &$crate::declared::TypeDoc {
                name: stringify!($name),
                comments: &[
                    $crate::declared::Comment {
                        variant: None,
                        field: None,
                        group: "",
                        lines: &[$($doc),*],
                    },
                    $($crate::declared::Comment {
                        variant: $variant,
                        field: $field,
                        group: concat!($($group)?),
                        lines: &[$($text),*],
                    },)*
                ],
            };
        }
    };
}
