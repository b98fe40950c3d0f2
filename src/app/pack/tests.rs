//! Names of files in a pack.

use super::*;

#[test]
fn the_common_folder_is_the_deepest_one() {
    let of = |folders: &[&str]| common_folder(folders.iter().map(Path::new));
    assert_eq!(of(&["/a/b", "/a/b"]), Path::new("/a/b"));
    assert_eq!(of(&["/a/b/c", "/a/bc", "/a/b"]), Path::new("/a"));
    assert_eq!(of(&["/a", "/b"]), Path::new("/"));
}

#[test]
fn asset_folders_elsewhere_do_not_tell_where_they_are() {
    let paths = ["/home/me/show/a.toml", "/srv/lib/x.glb", "/opt/more/y.glb"];
    let paths: BTreeSet<_> = paths.map(PathBuf::from).into();
    let assets = ["/srv/lib", "/opt/more"].map(PathBuf::from);
    let places = Places::for_files(Path::new("/home/me/show/a.toml"), None, &paths, &assets);
    let name = |path: &str| places.name(Path::new(path)).expect("it is UTF-8");
    assert_eq!(name("/home/me/show/a.toml"), "a.toml");
    assert_eq!(name("/srv/lib/x.glb"), "assets/x.glb");
    assert_eq!(name("/opt/more"), "assets-2");
    let few = BTreeSet::from(["/home/me/show/a.toml", "/srv/lib/x/x.glb"].map(PathBuf::from));
    let nested = ["/srv/lib/x", "/srv/lib"].map(PathBuf::from);
    let places = Places::for_files(Path::new("/home/me/show/a.toml"), None, &few, &nested);
    assert_eq!(
        places.name(Path::new("/srv/lib/x")).expect("it is UTF-8"),
        "assets/x"
    );
    let around = [PathBuf::from("/home/me")];
    let places = Places::for_files(Path::new("/home/me/show/a.toml"), None, &paths, &around);
    assert_eq!(
        places.name(Path::new("/home/me")).expect("it is inside"),
        "home/me"
    );
}

#[test]
fn names_are_from_the_common_folder() {
    let name = |path: &str| name_in(Path::new("/show"), Path::new(path));
    assert_eq!(name("/show/a/b.toml").expect("it is inside"), "a/b.toml");
    assert_eq!(name("/show").expect("the folder itself"), "");
    assert!(name("/other/b.toml").is_err());
    assert!(name("/show/a\\b.toml").is_err());
}
