//! Form of the table of features: from its rows follow the fields of `Features`, the pipeline constants, the shader
//! files, and the list of dropped features.

use serde::Serialize;

/// A feature that was left out, and the reason why that changes nothing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// Name of the feature.
    pub what: &'static str,
    /// Reason that it is unused.
    pub why: &'static str,
}

/// Two shader files, one of which stands for an import.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileChoice {
    /// Name of the import.
    pub import: &'static str,
    /// Endings of the two files `lib/IMPORT_ENDING.wgsl`: without the feature, and with it.
    pub endings: [&'static str; 2],
}

/// A row of the table, for a set `F` of features.
#[derive(Clone, Copy, Debug)]
pub struct FeatureRow<F> {
    /// Name of the field in the set of features.
    pub name: &'static str,
    /// Pipeline constant that is true with the feature; shaders that declare it as an `override` get it.
    pub constant: Option<&'static str>,
    /// Shader files that the feature chooses.
    pub files: &'static [FileChoice],
    /// Whether the feature is in a set.
    pub get: fn(&F) -> bool,
    /// Field of the feature in a set; `None` for a feature that follows from others.
    pub own: Option<fn(&mut F) -> &mut bool>,
}

/// Declares the features of a frame. A row names, in this order:
///
/// - `used:` the condition under which a scene needs the feature, or `follows:` the condition by which it follows from
///   features above it;
/// - `constant:` the pipeline constant that is true with the feature;
/// - `files:` imports, each with the endings of the file without the feature and of the file with it;
/// - `dropped:` name and reason of its absence, for the user, and `if` there is a condition under which the absence
///   is worth telling.
macro_rules! features {
    (@optional) => { None };
    (@optional $value:expr) => { Some($value) };
    (@optional_name) => { None };
    (@optional_name $name:ident) => { Some(stringify!($name)) };
    (@first $value:expr; $unused:expr) => { $value };
    (
        $(#[$set_doc:meta])*
        pub struct $set:ident of $scene:ident: $scene_type:ty;
        $(
            $(#[$doc:meta])*
            $name:ident {
                $(used: $used:expr,)?
                $(follows: $follows:expr,)?
                $(constant: $constant:ident,)?
                $(files: $($import:ident [$without:ident, $with:ident]),+;)?
                $(dropped: $what:literal => $why:literal $(, if $when:expr)?;)?
            }
        )*
    ) => {
        $(#[$set_doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $set {
            $($(#[$doc])* pub $name: bool,)*
        }

        impl $set {
            /// All features.
            pub const ROWS: [FeatureRow<Self>; [$(stringify!($name)),*].len()] = [$(FeatureRow {
                name: stringify!($name),
                constant: features!(@optional_name $($constant)?),
                files: &[$($(FileChoice {
                    import: stringify!($import),
                    endings: [stringify!($without), stringify!($with)],
                }),+)?],
                get: |set| set.$name,
                own: features!(@optional $(features!(@first |set| &mut set.$name; $used))?),
            }),*];

            /// Features that a scene needs, and the dropped features.
            pub fn for_scene($scene: $scene_type) -> (Self, Vec<Dropped>) {
                let mut dropped = Vec::new();
                $(
                    let $name: bool = $($used)? $($follows)?;
                    $(if !$name $(&& $when)? {
                        dropped.push(Dropped { what: $what, why: $why });
                    })?
                )*
                (Self { $($name),* }, dropped)
            }

            /// The set, with the features that follow from it.
            pub fn with_followers(self) -> Self {
                $(let $name: bool = $(features!(@first self.$name; $used))? $($follows)?;)*
                Self { $($name),* }
            }
        }
    };
}
pub(super) use features;
