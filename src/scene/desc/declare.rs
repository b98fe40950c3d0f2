//! Declarations of the tables of scene text: each key once, with its comment, type, range and default.

/// Declares types of scene text. Enums and structs are written as anywhere else, and have their comments for the manual
/// from here. After `#[derive(…)]`, a struct says what is made of its fields:
///
/// - `#[defaults]`: an `impl Default` of the defaults that stand at the fields, else of their types.
/// - `#[keys]`: an `impl Keys`, the reader of its keys, for an `impl Section` that does more than to read them;
///   `#[table("[heading]")]`: the `impl Section` too; after the heading perhaps a function that refuses values which do
///   not go together.
/// - `#[tracks(NAME)]`: a static table of the fields that may change over time.
///
/// A field with `= default` may be left out, and an `Option`; any other must be written. Before it stand, in this order:
///
/// - `#[within(RANGE)]`: range of its numbers; any number without it.
/// - `#[form(Color)]`: type of the value in scene text, whose content the field has.
/// - `#[by(function)]`: reads the key by a function of the table, which returns `None` where a required key is missing
///   or wrong.
/// - `#[track(Number, "opacity")]`: form of its tracks, and their quantity in the manual; perhaps a function that gives
///   its value where it is left out.
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

/// Makes a part of the declaration of a struct: the type, its defaults, its reader or its table of tracks.
macro_rules! made_of_fields {
    (
        plain([$($doc:literal)*] $($derived:ident)*)
        $name:ident {
            $(
                $(#[doc = $text:literal])*
                $(#[within($range:expr)])?
                $(#[form($form:ident)])?
                $(#[by($by:expr)])?
                $(#[track($($track:tt)*)])?
                pub $field:ident: $type:ty $(= $default:expr)?
            ),* $(,)?
        }
    ) => {
        $(#[doc = $doc])*
        #[derive($($derived),*)]
        pub struct $name {
            $($(#[doc = $text])* pub $field: $type,)*
        }

        documented!($name $($doc)*; $((None, Some(stringify!($field))) $($text)*;)*);
    };
    (
        defaults()
        $name:ident {
            $(
                $(#[doc = $text:literal])*
                $(#[within($range:expr)])?
                $(#[form($form:ident)])?
                $(#[by($by:expr)])?
                $(#[track($($track:tt)*)])?
                pub $field:ident: $type:ty $(= $default:expr)?
            ),* $(,)?
        }
    ) => {
        impl Default for $name {
            fn default() -> Self {
                Self { $($field: or!([$($default)?] Default::default()),)* }
            }
        }
    };
    (
        keys()
        $name:ident {
            $(
                $(#[doc = $text:literal])*
                $(#[within($range:expr)])?
                $(#[form($form:ident)])?
                $(#[by($by:expr)])?
                $(#[track($($track:tt)*)])?
                pub $field:ident: $type:ty $(= $default:expr)?
            ),* $(,)?
        }
    ) => {
        impl $crate::table::Keys for $name {
            fn read_keys(t: &mut $crate::table::Table) -> Option<Self> {
                $(let $field = read_key!(
                    t stringify!($field), $type; or!([$($range)?] $crate::range::ANY);
                    [$($form)?] [$($by)?] [$($default)?]
                );)*
                Some(Self { $($field: $field?),* })
            }
        }
    };
    (table($heading:literal $(, $check:expr)?) $name:ident $fields:tt) => {
        made_of_fields! { keys() $name $fields }

        impl $crate::table::Section for $name {
            const HEADING: &'static str = $heading;

            fn read(t: &mut $crate::table::Table) -> Option<Self> {
                let it = $crate::table::Keys::read_keys(t)?;
                $($crate::table::check(t, &it, $check);)?
                Some(it)
            }
        }
    };
}

/// Reads a key as the entry of its field says, to an `Option` of the field's type.
macro_rules! read_key {
    ($t:ident $key:expr, $type:ty; $range:expr; [] [] []) => {
        <$type as $crate::table::Key>::read($t, $key, $range)
    };
    ($t:ident $key:expr, $type:ty; $range:expr; [] [] [$default:expr]) => {
        Some($t.get::<$type>($key, $range, $default))
    };
    ($t:ident $key:expr, $type:ty; $range:expr; [$form:ident] [] [$default:expr]) => {
        Some($t.get($key, $range, $form($default)).0)
    };
    ($t:ident $key:expr, $type:ty; $range:expr; [] [$by:expr] $default:tt) => {
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
