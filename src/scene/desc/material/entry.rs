//! Declarations, rows and numbers that follow from the entry of a key of a material.

/// Declares the keys of a material in the order of the manual, each with its comment and its type.
///
/// - `#[group("…")]`: group of the key and of the keys below until the next group, in the manual and in panels.
/// - `KEY under OTHER | THIRD`: the key has no effect without one of the others.
/// - `[RANGE]`: a key that is read as a value of its type; `in EXTENSIONS`: extensions of the files that its text names.
/// - `FORM in RANGE, "…"`: a number or color that tracks and scripts may change, and a name of its quantity for the text of
///   its track. It may also follow a pattern, `varies NAME`. Then its value where a material leaves it out: `rest VALUE`; or
///   for a number without which a material lacks something that costs time, `off "VALUE"`, a value in scene text that
///   changes nothing, or `such_as "VALUE"`. After `=>` a loaded material has it in its [`MaterialNumbers`], after `apart`
///   it has it in another form.
/// - `of NUMBER`: the number of an extension of glTF that it is, as in [`LAYER_NUMBERS`].
/// - Without a range: a key that the reader of materials reads by itself.
macro_rules! material {
    (
        $(#[doc = $doc:literal])*
        pub struct MaterialDesc {
            $(
                $(#[doc = $text:literal])*
                $(#[group($group:literal)])?
                $key:ident $(under $needed:ident $(| $or:ident)*)*: $type:ty
                $([$plain_range:expr] $(in $files:expr)?)?
                $(,
                    $form:ident in $range:expr, $what:literal $(of $gltf:tt)? $(varies $varies:ident)?
                    $(=> $at_rest:ident $value:expr)?
                    $(, apart $elsewhere:ident $other:expr)?
                )?
            ;)*
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq, Default)]
        pub struct MaterialDesc {
            $($(#[doc = $text])* pub $key: Option<$type>,)*
            /// Numbers and colors that follow a pattern; the fields above have the mean of each.
            pub patterned: Vec<PatternedDesc>,
        }

        documented!(MaterialDesc $($doc)*; $((None, Some(stringify!($key)) $(, in $group)?) $($text)*;)*);

        /// Default values of keys that a material leaves out.
        pub const PLAIN: MaterialDesc = MaterialDesc {
            $($key: at_rest!(plain $($($at_rest $value)? $($elsewhere $other)?)?),)*
            patterned: Vec::new(),
        };

        /// Number of values of a material that may change.
        pub const MATERIAL_FIELDS: usize = [$($(stringify!($form),)?)*].len() + 3;

        /// Values of a material that tracks and scripts may change.
        pub static MATERIAL: [Field<MaterialDesc>; MATERIAL_FIELDS] = [
            $($(Field {
                key: stringify!($key),
                what: $what,
                form: Form::$form,
                range: $range,
                get: |it| it.$key.map(Lanes::lanes),
                put: |it, value| {
                    it.patterned.retain(|p| p.value.key() != stringify!($key));
                    it.$key = Some(Lanes::from_lanes(value));
                },
            },)?)*
            of_checkers!("checker_a", "first color", Color, UNIT, |checker| checker.colors[0]),
            of_checkers!("checker_b", "second color", Color, UNIT, |checker| checker.colors[1]),
            of_checkers!("checker_size_m", "cell size", ", meters", Number, ABOVE_0, |checker| checker.size_m),
        ];

        /// Numbers of extensions of glTF: extension without `KHR_materials_` and key there, key of scene text; an empty
        /// one has no counterpart.
        pub const LAYER_NUMBERS: &[(&str, &str)] = &[
            $($($(($gltf, stringify!($key)),)?)?)*
            ("ior/ior", ""),
            ("volume/thicknessFactor", ""),
            ("iridescence/iridescenceThicknessMinimum", ""),
        ];

        /// Tracks of the values of [`MATERIAL`], in its order.
        static TRACKS: [Track; MATERIAL_FIELDS] = [
            $($(Track {
                needs: at_rest!(needs $key $($at_rest $value)? $($elsewhere $other)?),
                off: at_rest!(off $($at_rest $value)? $($elsewhere $other)?),
            },)?)*
            OF_CHECKER,
            OF_CHECKER,
            OF_CHECKER,
        ];

        /// Keys that have no effect without others, in the order of the manual. Motion of a key requires it in the
        /// table as well.
        pub static NEEDING: &[Needing] = &[$($(Needing {
            key: stringify!($key),
            needs: stringify!($needed),
            is_alone: |it| it.$key.is_some() && it.$needed.is_none() $(&& it.$or.is_none())*,
        },)*)*];

        /// A number or color of a material that may follow a pattern.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum PatternedKey {
            $($($(#[doc = concat!("Key `", stringify!($key), "`.")] $varies,)?)?)*
            /// Height, of key `bump`.
            Bump,
        }

        impl PatternedKey {
            /// All of them.
            pub const ALL: [Self; [$($($(stringify!($varies),)?)?)*].len() + 1] =
                [$($($(Self::$varies,)?)?)* Self::Bump];

            /// Key in scene text.
            pub const fn key(self) -> &'static str {
                match self {
                    $($($(Self::$varies => stringify!($key),)?)?)*
                    Self::Bump => "bump",
                }
            }
        }

        /// Numbers of a loaded material that are plain values of its keys; `None` where it has nothing of their kind.
        #[derive(Clone, Debug, PartialEq)]
        pub struct MaterialNumbers {
            $($($(
                #[doc = concat!("Value of [`", stringify!($key), "`](MaterialDesc::", stringify!($key), ").")]
                pub $key: at_rest!(type $at_rest $type),
            )?)?)*
        }

        impl Default for MaterialNumbers {
            fn default() -> Self {
                Self { $($($($key: at_rest!(loaded $at_rest $value),)?)?)* }
            }
        }

        impl MaterialNumbers {
            /// The numbers as a description.
            pub fn desc(&self) -> MaterialDesc {
                MaterialDesc {
                    $($($($key: at_rest!(it $at_rest self.$key).into(),)?)?)*
                    ..MaterialDesc::default()
                }
            }

            /// Takes the numbers that a description has.
            pub fn set(&mut self, desc: &MaterialDesc) {
                $($($(if let Some(value) = at_rest!(it $at_rest desc.$key) {
                    self.$key = value.into();
                })?)?)*
            }
        }

        impl MaterialDesc {
            /// Reads the keys that have a range; a pattern in place of a number or color is added to `patterned`.
            fn read_keys(&mut self, t: &mut Table, patterned: &mut Vec<PatternedDesc>) {
                $(
                    $(
                        self.$key = t.find(stringify!($key), $plain_range);
                        $(t.files(stringify!($key), $files);)?
                    )?
                    $(self.$key = at_rest!(read t patterned $key $form $range $(, $varies)?);)?
                )*
            }

            /// Values of `over`, and of `self` where `over` has none.
            pub fn overlaid(&self, over: &Self) -> Self {
                let kept = |pattern: &&PatternedDesc| !over.has(pattern.value.key());
                let kept = self.patterned.iter().filter(kept);
                Self {
                    $($key: over.$key.clone().or_else(|| self.$key.clone()),)*
                    patterned: kept.chain(&over.patterned).copied().collect(),
                }
            }
        }
    };
}

/// Parts of [`material!`] that depend on the entry of a number: its value where a material leaves it out, its pattern.
macro_rules! at_rest {
    (plain rest $value:expr) => { Some($value) };
    (plain $($other:tt)*) => { None };
    (type rest $type:ty) => { $type };
    (type $kind:ident $type:ty) => { Option<$type> };
    (loaded rest $value:expr) => { $value };
    (loaded $kind:ident $value:expr) => { None };
    (needs $key:ident rest $value:expr) => { "" };
    (needs $key:ident $kind:ident $value:expr) => { concat!(stringify!($key), " = ", $value) };
    (off off $value:expr) => { $value };
    (off $kind:ident $value:expr) => { "" };
    (it $kind:ident $it:expr) => { $it };
    (read $t:ident $patterned:ident $key:ident Color $range:expr) => {
        $t.find(stringify!($key), $range).map(|Color(color)| color)
    };
    (read $t:ident $patterned:ident $key:ident Color $range:expr, $varies:ident) => {
        read::color($t, PatternedKey::$varies, $range, $patterned)
    };
    (read $t:ident $patterned:ident $key:ident $form:ident $range:expr) => {
        $t.find(stringify!($key), $range)
    };
    (read $t:ident $patterned:ident $key:ident $form:ident $range:expr, $varies:ident) => {
        read::number($t, PatternedKey::$varies, $range, $patterned)
    };
}

/// Row of [`MATERIAL`] for a value of the material's checker or pattern.
macro_rules! of_checkers {
    ($key:literal, $what:literal, $($unit:literal,)? $form:ident, $range:expr, |$checker:ident| $value:expr) => {
        Field {
            key: $key,
            what: concat!($what, " of its `checker` or `pattern`" $(, $unit)?),
            form: Form::$form,
            range: $range,
            get: |it| it.checker.as_ref().map(|$checker| $value.lanes()),
            put: |it, value| {
                if let Some($checker) = &mut it.checker {
                    $value = Lanes::from_lanes(value);
                }
            },
        }
    };
}
