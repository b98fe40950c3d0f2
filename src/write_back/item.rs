//! Items of a scene that can be selected, and origins of the materials that instances show.

use super::places::Subject;
use reflet_scene::{
    desc::{Entry, MaterialDesc, SceneDesc},
    diagnostic::Span,
    motion::{ModelTables, override_of},
};

/// An item of a scene with numbers that can be changed: an index into the list of its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SceneItem {
    /// Index into [`SceneDesc::instances`].
    Instance(usize),
    /// Index into [`SceneDesc::groups`].
    Group(usize),
    /// Index into [`SceneDesc::decals`].
    Decal(usize),
    /// Index into [`SceneDesc::lights`].
    Light(usize),
    /// Index into [`SceneDesc::cameras`].
    Camera(usize),
    /// Index into [`SceneDesc::models`] of a model that no instance places, and that is shown once.
    Model(usize),
    /// The environment.
    #[default]
    Environment,
}

/// Table in which the values of a material stand, or can be overridden.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MaterialOrigin {
    /// Index into [`SceneDesc::materials`].
    Named(usize),
    /// Index of the instance whose own `material = { … }` it is.
    Instance(usize),
    /// Index of the model, and name of the material in the model's file: `[model.M.material.NAME]`.
    File(usize, String),
}

impl SceneItem {
    /// Name of the item, if it has one, and the place of its table.
    pub fn named(self, desc: &SceneDesc) -> Option<(Option<&str>, &Span)> {
        fn entry<T>(list: &[Entry<T>], index: usize) -> Option<(Option<&str>, &Span)> {
            list.get(index).map(|e| (Some(e.name.as_str()), &e.at))
        }
        match self {
            Self::Instance(i) => desc.instances.get(i).map(|i| (i.name.as_deref(), &i.at)),
            Self::Group(i) => entry(&desc.groups, i),
            Self::Decal(i) => entry(&desc.decals, i),
            Self::Light(i) => entry(&desc.lights, i),
            Self::Camera(i) => entry(&desc.cameras, i),
            Self::Model(i) => entry(&desc.models, i),
            Self::Environment => Some((None, &desc.own)),
        }
    }

    /// The item of the same name in a reloaded scene; without a name, the item of the same index.
    pub fn again(self, desc: &SceneDesc, name: Option<&str>) -> Option<Self> {
        let Some(name) = name else {
            return self.named(desc).map(|_| self);
        };
        fn index_of<T>(list: &[Entry<T>], name: &str) -> Option<usize> {
            list.iter().position(|e| e.name == name)
        }
        match self {
            Self::Instance(_) => {
                let mut all = desc.instances.iter();
                all.position(|i| i.name.as_deref() == Some(name))
                    .map(Self::Instance)
            }
            Self::Group(_) => index_of(&desc.groups, name).map(Self::Group),
            Self::Decal(_) => index_of(&desc.decals, name).map(Self::Decal),
            Self::Light(_) => index_of(&desc.lights, name).map(Self::Light),
            Self::Camera(_) => index_of(&desc.cameras, name).map(Self::Camera),
            Self::Model(_) => {
                let is_it = |index: &usize| desc.models[*index].name == name;
                desc.unplaced_models().find(is_it).map(Self::Model)
            }
            Self::Environment => Some(self),
        }
    }

    /// Kind and name of the item.
    pub fn label(self, desc: &SceneDesc) -> String {
        self.label_among(desc, &desc.instance_names())
    }

    /// Kind and name of the item, where `names` are [`SceneDesc::instance_names`].
    pub(super) fn label_among(self, desc: &SceneDesc, names: &[String]) -> String {
        let name = match self {
            Self::Instance(i) => names.get(i).map(String::as_str),
            item => item.named(desc).and_then(|(name, _)| name),
        };
        let kind = self.kind();
        name.map_or_else(|| kind.to_owned(), |name| format!("{kind} {name}"))
    }

    /// Key of the item's kind in scene text.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Instance(_) => "instance",
            Self::Group(_) => "group",
            Self::Decal(_) => "decal",
            Self::Light(_) => "light",
            Self::Camera(_) => "camera",
            Self::Model(_) => "model",
            Self::Environment => "environment",
        }
    }

    /// Type of the item's table in `desc.rs`.
    pub(super) fn section(self) -> &'static str {
        match self {
            Self::Instance(_) => "InstanceDesc",
            Self::Group(_) => "GroupDesc",
            Self::Decal(_) => "DecalDesc",
            Self::Light(_) => "LightDesc",
            Self::Camera(_) => "CameraDesc",
            Self::Model(_) => "ModelDesc",
            Self::Environment => "EnvironmentDesc",
        }
    }

    /// The item's table.
    pub(super) fn subject(self, desc: &SceneDesc) -> Result<Subject<'_>, String> {
        let (name, at) = self.named(desc).ok_or("it is not there any more")?;
        Ok(Subject {
            kind: self.kind(),
            section: self.section(),
            name,
            at: (self != Self::Environment).then_some(at),
            below: &[],
        })
    }
}

impl MaterialOrigin {
    /// Name and place of the thing that has the material.
    pub fn named<'d>(&self, desc: &'d SceneDesc) -> Option<(Option<&'d str>, &'d Span)> {
        match self {
            Self::Named(i) => desc
                .materials
                .get(*i)
                .map(|e| (Some(e.name.as_str()), &e.at)),
            Self::Instance(i) => SceneItem::Instance(*i).named(desc),
            Self::File(i, _) => desc.models.get(*i).map(|e| (Some(e.name.as_str()), &e.at)),
        }
    }

    /// The table as scene text names it.
    pub fn label(&self, desc: &SceneDesc) -> String {
        let name = self.named(desc).and_then(|(name, _)| name);
        match (self, name) {
            (Self::Named(_), name) => format!("[material.{}]", name.unwrap_or_default()),
            (Self::Instance(_), Some(name)) => format!("material of instance {name}"),
            (Self::Instance(_), None) => "material of its instance".to_owned(),
            (Self::File(_, material), name) => {
                format!("[model.{}.material.{material}]", name.unwrap_or_default())
            }
        }
    }

    /// A number of the table in the text, where it has one.
    pub fn written(
        &self,
        desc: &SceneDesc,
        number: impl Fn(&MaterialDesc) -> Option<f32>,
    ) -> Option<f32> {
        match self {
            Self::Named(i) => number(&desc.materials.get(*i)?.value),
            Self::Instance(i) => number(override_of(desc.instances.get(*i)?)?),
            Self::File(i, name) => {
                let tables = ModelTables::for_model(desc.models.get(*i));
                number(&tables.written(name))
            }
        }
    }

    /// Keys from the thing's table to the material's.
    pub(super) fn below(&self) -> Vec<&str> {
        match self {
            Self::Named(_) => Vec::new(),
            Self::Instance(_) => vec!["material"],
            Self::File(_, name) => vec!["material", name],
        }
    }

    /// The thing's table, and the table `below` it.
    pub(super) fn subject<'a>(
        &self,
        desc: &'a SceneDesc,
        below: &'a [&'a str],
    ) -> Result<Subject<'a>, String> {
        let (name, at) = self.named(desc).ok_or("it is not there any more")?;
        let kind = match self {
            Self::Named(_) => "material",
            Self::Instance(_) => "instance",
            Self::File(..) => "model",
        };
        Ok(Subject {
            kind,
            section: "MaterialDesc",
            name,
            at: Some(at),
            below,
        })
    }
}
