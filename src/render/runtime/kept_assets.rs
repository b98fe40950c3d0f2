//! Loads several texts of a scene over the same files, such as its variants, which are read once.

use super::scene_text::{LoadedScene, OpenedScene};
use reflet_scene::diagnostic::Diagnostic;
use reflet_world::{World, load::AssetCache};

/// Assets of a scene for other texts over the same files.
#[derive(Default)]
pub struct KeptAssets(Option<(World, AssetCache)>);

impl KeptAssets {
    /// Loads a scene; `name` is used in messages. Files are read only where the assets of the scenes before do not
    /// suffice; their assets are kept then.
    ///
    /// # Errors
    /// Same errors as [`OpenedScene::load`].
    pub fn load(
        &mut self,
        opened: &OpenedScene,
        name: String,
    ) -> Result<LoadedScene, Vec<Diagnostic>> {
        if let Some((kept, assets)) = &mut self.0 {
            let reused = assets.reuse_assets(kept, &opened.scene, &opened.options);
            if let Some(world) = reused.map_err(|errors| opened.after_warnings(errors))? {
                let world = World {
                    meshes: kept.meshes.clone(),
                    textures: kept.textures.clone(),
                    ..world
                };
                return Ok(opened.with_world(name, world));
            }
        }
        let (world, assets) = opened.world()?;
        self.0 = Some((world.clone(), assets));
        Ok(opened.with_world(name, world))
    }
}
