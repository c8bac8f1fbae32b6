//! What scenes pull in from disk, and how files fail.

use crate::temporary::Folder;
use image::{ExtendedColorType, ImageFormat};
use raywalk::scene::{LoadOptions, Scene, SceneError, Texture, load};
use std::path::Path;
use std::sync::Arc;

/// A scene with one image texture.
fn load_image(folder: &Folder, file: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    folder.load(format!(r#"{{ "version": 1, "textures": {{ "t": {{ "image": "{file}" }} }} }}"#), options)
}

fn write_image(folder: &Folder, name: &str, (width, height): (u32, u32), color: ExtendedColorType) {
    let size = width as usize * height as usize * usize::from(color.bits_per_pixel()) / 8;
    let bytes: Vec<u8> = (0..size).map(|i| (i * 7) as u8).collect();
    let format = ImageFormat::from_path(name).unwrap();
    image::save_buffer_with_format(folder.write(name, ""), &bytes, width, height, color, format).unwrap();
}

fn error(folder: &Folder, file: &str) -> String {
    load_image(folder, file, &LoadOptions::default()).unwrap_err().to_string()
}

#[test]
fn images_of_every_kind_become_rgb_texels() {
    let folder = Folder::new();
    let files = [
        ("rgb.png", ExtendedColorType::Rgb8),
        ("gray.png", ExtendedColorType::L8),
        ("alpha.png", ExtendedColorType::Rgba8),
        ("deep.png", ExtendedColorType::Rgb16),
        ("photo.jpg", ExtendedColorType::Rgb8),
        ("old.bmp", ExtendedColorType::Rgb8),
    ];
    for (name, color) in files {
        write_image(&folder, name, (5, 3), color);
        let scene = load_image(&folder, name, &LoadOptions::default()).unwrap();
        let Texture::Image(image) = &scene.textures[0] else { panic!("{name}: an image") };
        assert_eq!((image.texels.width(), image.texels.height(), image.size), (5, 3, 1.0), "{name}");
    }
}

#[test]
fn an_image_named_twice_is_decoded_once() {
    let folder = Folder::new();
    write_image(&folder, "a.png", (4, 4), ExtendedColorType::Rgb8);
    let text = r#"{ "version": 1, "textures": { "a": { "image": "a.png" }, "b": { "image": "./a.png", "size": 3 } } }"#;
    // The budget holds what it takes to make a copy, but not two copies.
    let mut options = LoadOptions::default();
    options.limits.set("texture-bytes", "160").unwrap();
    let scene = folder.load(text, &options).unwrap();
    let [Texture::Image(a), Texture::Image(b)] = &scene.textures[..] else { panic!("two images") };
    assert!(Arc::ptr_eq(&a.texels, &b.texels));
    assert_eq!(b.size, 3.0);
}

#[test]
fn images_hold_the_limits() {
    let folder = Folder::new();
    write_image(&folder, "wide.png", (100, 1), ExtendedColorType::Rgb8);
    // It has 400 bytes, 533 with its smaller sizes, and both are there when these are made.
    for (limit, value) in [("texture-edge", "99"), ("texture-bytes", "299"), ("texture-bytes", "900")] {
        let mut options = LoadOptions::default();
        options.limits.set(limit, value).unwrap();
        let error = load_image(&folder, "wide.png", &options).unwrap_err().to_string();
        assert!(error.contains(&format!("limit {limit} of {value}")), "{error}");
    }
}

#[test]
fn a_broken_or_missing_image_is_an_error_with_its_place() {
    let folder = Folder::new();
    write_image(&folder, "good.png", (50, 50), ExtendedColorType::Rgb8);
    let whole = std::fs::read(folder.path().join("good.png")).unwrap();
    folder.write("cut.png", &whole[..whole.len() / 2]);
    folder.write("text.png", "not an image");
    folder.write("folder.png/x", "");
    for (file, says) in [
        ("cut.png", "cannot decode"),
        ("text.png", "cannot decode"),
        ("missing.png", "No such file"),
        ("folder.png", "not a regular file"),
    ] {
        let error = error(&folder, file);
        assert!(error.contains("s.json:1:") && error.contains("(/textures/t/image)"), "{error}");
        assert!(error.contains(says) || cfg!(not(unix)), "{error}");
    }
}

#[test]
fn paths_stay_in_the_scenes_folder() {
    let folder = Folder::new();
    write_image(&folder, "out.png", (2, 2), ExtendedColorType::Rgb8);
    let inner = folder.write("inner/s.json", r#"{ "version": 1, "textures": { "t": { "image": "../out.png" } } }"#);
    let refused = load(&inner, &LoadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("leaves the scene's folder"), "{refused}");
    let absolute = folder.path().join("out.png");
    assert!(error(&folder, &absolute.display().to_string().replace('\\', "/")).contains("leaves the scene's folder"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&absolute, folder.path().join("inner/link.png")).unwrap();
        let text = r#"{ "version": 1, "textures": { "t": { "image": "link.png" } } }"#;
        let linked = load(&folder.write("inner/s.json", text), &LoadOptions::default()).unwrap_err().to_string();
        assert!(linked.contains("leaves the scene's folder"), "{linked}");
    }
}

#[test]
fn files_that_are_no_scenes_say_why() {
    let folder = Folder::new();
    let load = |path: &Path| load(path, &LoadOptions::default()).unwrap_err().to_string();
    let missing = load(&folder.path().join("missing.json"));
    assert!(missing.contains("missing.json: cannot read the scene"), "{missing}");
    let unknown = load(&folder.write("scene.txt", "{}"));
    assert!(unknown.contains("unknown scene format") && unknown.contains(".json"), "{unknown}");
    assert!(load(folder.path()).contains("not a regular file"));
}

#[test]
fn images_of_the_corpus_never_panic() {
    for part in ["images", "bad/images"] {
        let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(part);
        let Ok(files) = std::fs::read_dir(corpus) else { continue };
        let folder = Folder::new();
        for file in files.map(Result::unwrap).filter(|f| f.path().is_file()) {
            let name = file.file_name().into_string().unwrap();
            folder.write(&name, std::fs::read(file.path()).unwrap());
            if let Err(error) = load_image(&folder, &name, &LoadOptions::default()) {
                assert!(matches!(error, SceneError::Invalid { .. }), "{name}: {error}");
            }
        }
    }
}
