//! XML scenes: they say what JSON says, and mistakes are told with their place.

use crate::corpus::PATIENCE;
use crate::temporary::Folder;
use raywalk::scene::{LoadOptions, Scene, SceneError, load};
use std::time::Instant;

fn load_xml(text: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    load(&Folder::new().write("s.xml", text), &LoadOptions::default())
}

/// All that a scene holds, as text.
fn contents(scene: &Scene) -> String {
    let Scene { objects, materials, textures, lights, cameras, render, .. } = scene;
    format!("{objects:#?}\n{materials:#?}\n{textures:#?}\n{lights:#?}\n{cameras:#?}\n{render:#?}")
}

#[test]
fn the_same_tree_gives_the_same_scene() {
    let folder = Folder::new();
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let json = folder.load(include_str!("../every_type.json"), &strict).unwrap();
    let xml = load(&folder.write("s.xml", include_str!("every_type.xml")), &strict).unwrap();
    assert_eq!((xml.name.as_str(), xml.format, json.format), ("s.xml", "XML", "JSON"));
    assert_eq!(contents(&xml), contents(&json));
    assert_eq!(xml.geometry.len(), json.geometry.len());
}

/// A wrong scene, the `§` where the error is, the XPath of its place and words of its message.
const WRONG: &[(&str, &str, &str)] = &[
    ("§<scene version=\"1\"", "", "not valid XML"),
    ("<scene version=\"1\">\n <objects>§</scene>", "", "not valid XML"),
    ("<scene version=\"1\" §version=\"1\"/>", "", "not valid XML"),
    ("<scene version=\"1\"/>§<scene version=\"1\"/>", "", "not valid XML"),
    ("§<!DOCTYPE scene [<!ENTITY a \"b\">]>\n<scene version=\"1\"/>", "", "DOCTYPE"),
    ("§<scenes version=\"1\"/>", "/scenes", "expected <scene>"),
    ("§<scene/>", "/scene", "missing key \"version\""),
    ("<scene version=\"§2\"/>", "/scene/@version", "expected 1"),
    ("<scene version=\"§one\"/>", "/scene/@version", "expected a number, found a string"),
    ("<scene version=\"1\">\n  §stray\n  <objects/></scene>", "/scene", "unexpected text \"stray\""),
    ("<scene version=\"1\"><camera position=\"0 §x 5\"/></scene>", "/scene/camera/@position", "expected a number"),
    (
        "<scene version=\"1\"><camera position=\"§0 5\"/></scene>",
        "/scene/camera/@position",
        "expected 3 numbers, found 2",
    ),
    ("<scene version=\"1\"><camera position=\"0 1 §1e39\"/></scene>", "/scene/camera/@position", "too large"),
    ("<scene version=\"1\"><camera position=\"0 1 §nan\"/></scene>", "/scene/camera/@position", "expected a number"),
    ("<scene version=\"1\" camera=\"§big\"/>", "/scene/@camera", "expected an element, found a string"),
    ("<scene version=\"1\"><lights/><§lights/></scene>", "/scene/lights[2]", "stands twice"),
    (
        "<scene version=\"1\"><render width=\"8\"><§width>8</width></render></scene>",
        "/scene/render/width",
        "stands twice",
    ),
    (
        "<scene version=\"1\"><materials><§material ior=\"1\"/></materials></scene>",
        "/scene/materials/material",
        "missing id",
    ),
    (
        "<scene version=\"1\"><materials><§texture id=\"a\"/></materials></scene>",
        "/scene/materials/texture[@id='a']",
        "expected <material>",
    ),
    (
        "<scene version=\"1\"><materials><material id=\"a\"/><material id=\"§a\"/></materials></scene>",
        "/scene/materials/material[@id='a']/@id",
        "\"a\" stands twice",
    ),
    (
        "<scene version=\"1\"><materials><material id=\"a\" color=\"§#12345\"/></materials></scene>",
        "/scene/materials/material[@id='a']/@color",
        "#rrggbb",
    ),
    (
        "<scene version=\"1\"><render environment=\"§sunset\"/></scene>",
        "/scene/render/@environment",
        "unknown environment \"sunset\"",
    ),
    (
        "<scene version=\"1\"><render>§<environment zenith=\"1\"/></render></scene>",
        "/scene/render/environment",
        "needs an image or",
    ),
    (
        "<scene version=\"1\"><render><environment image=\"§nowhere.exr\"/></render></scene>",
        "/scene/render/environment/@image",
        "cannot read the environment",
    ),
    ("<scene version=\"1\"><objects §size=\"1\"/></scene>", "/scene/objects/@size", "unexpected attribute \"size\""),
    ("<scene version=\"1\"><objects><§ball/></objects></scene>", "/scene/objects/ball", "unknown object type \"ball\""),
    (
        "<scene version=\"1\"><objects><sphere center=\"0 0 0\" radius=\"1\"/><sphere center=\"0 0 0\" radius=\"§-1\"/></objects></scene>",
        "/scene/objects/sphere[2]/@radius",
        "greater than 0",
    ),
    (
        "<scene version=\"1\"><objects><sphere center=\"0 0 0\" radius=\"1\" §type=\"box\"/></objects></scene>",
        "/scene/objects/sphere/@type",
        "\"type\" stands twice",
    ),
    (
        "<scene version=\"1\"><objects><sphere center=\"0 0 0\" radius=\"1\" material=\"§rde\"/></objects>\n<materials><material id=\"red\"/></materials></scene>",
        "/scene/objects/sphere/@material",
        "did you mean \"red\"?",
    ),
    (
        "<scene version=\"1\"><objects><mesh>\n<vertices>0 0 0,\n 1 §x 0</vertices><triangles/></mesh></objects></scene>",
        "/scene/objects/mesh/vertices",
        "expected a number",
    ),
    (
        "<scene version=\"1\"><objects><mesh><vertices>§0 0</vertices><triangles/></mesh></objects></scene>",
        "/scene/objects/mesh/vertices",
        "expected 3 numbers, found 2",
    ),
    (
        "<scene version=\"1\"><objects><mesh><vertices>0 0 0</vertices><triangles>0 0 §1</triangles></mesh></objects></scene>",
        "/scene/objects/mesh/triangles",
        "index 1 names none of the 1 vertices",
    ),
    (
        "<scene version=\"1\"><objects><mesh><vertices>§0 0 0, <!-- x --> 1 0 0</vertices><triangles/></mesh></objects></scene>",
        "/scene/objects/mesh/vertices",
        "a comment may not stand within a text",
    ),
];

#[test]
fn every_wrong_scene_is_refused_with_its_place() {
    for (text, pointer, says) in WRONG {
        let (before, after) = text.split_once('§').unwrap();
        let line = 1 + before.matches('\n').count();
        let column = 1 + before.rsplit('\n').next().unwrap().chars().count();
        let error = load_xml(format!("{before}{after}")).expect_err(text);
        let SceneError::Invalid { place, message } = &error else { panic!("{text}: {error}") };
        assert!(message.contains(says), "{error}\n{text}");
        assert_eq!(place.line_column, Some((line, column)), "{error}\n{text}");
        assert_eq!(place.pointer, *pointer, "{error}\n{text}");
        assert!(!error.to_string().contains('\n'), "{error:?}");
    }
}

#[test]
fn unknown_names_are_warned_of() {
    let text = "<scene version=\"1\"><objects>\n <sphere center=\"0 0 0\" radius=\"1\" colour=\"1\" id=\"x\"><nmae/></sphere></objects></scene>";
    let scene = load_xml(text).unwrap();
    let warnings: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[0].contains("s.xml:2:36 (/scene/objects/sphere[@id='x']/@colour): unknown key"), "{warnings:?}");
    assert!(warnings[2].contains("did you mean \"name\"?"), "{warnings:?}");
}

#[test]
fn entities_and_cdata_are_text() {
    let text = "<scene version='1'><objects><sphere center='0 0&#32;0' name='a &lt; b' radius='1'/>\
                <mesh name='c'><vertices><![CDATA[0 0 0, 1 0 0, 0 1 0]]></vertices><triangles>0&#32;1 2</triangles></mesh>\
                </objects></scene>";
    let scene = load_xml(text).unwrap();
    assert_eq!(scene.objects[0].name.as_deref(), Some("a < b"));
    assert_eq!(scene.geometry.len(), 2);
}

#[test]
fn texts_are_utf8() {
    load_xml("\u{FEFF}<scene version=\"1\"/>").unwrap();
    let error = load_xml(b"<scene\n version=\"\xFF\"/>").unwrap_err().to_string();
    assert!(error.contains("s.xml:2:11: the text is not UTF-8"), "{error}");
    let utf16: Vec<u8> = "<scene version=\"1\"/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(load_xml(utf16).is_err());
}

#[test]
fn what_would_cost_without_end_is_refused_at_once() {
    let deep = |levels: usize| format!("{}{}", "<a>".repeat(levels), "</a>".repeat(levels));
    let attributes: String = (0..300_000).map(|i| format!(" a{i}=''")).collect();
    let namespaces: String = (0..20_000).map(|i| format!("<a xmlns:n{i}='u'>")).collect();
    let entities = "<!DOCTYPE a [<!ENTITY b 'bbbb'><!ENTITY c '&b;&b;&b;'>]><a>&c;</a>".to_owned();
    let start = Instant::now();
    for (text, says) in [
        (deep(129), "limit nesting of 128"),
        (deep(1_000_000), "limit nesting of 128"),
        (format!("<scene{attributes}/>"), "256 attributes"),
        (namespaces, "16 namespaces"),
        (entities, "DOCTYPE"),
    ] {
        let error = load_xml(text).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    let mut options = LoadOptions::default();
    options.limits.set("objects", "10").unwrap();
    let many = format!("<scene version=\"1\"><objects>{}</objects></scene>", "<sphere/>".repeat(1000));
    let error = load(&Folder::new().write("s.xml", many), &options).unwrap_err().to_string();
    assert!(error.contains("limit objects of 10"), "{error}");
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
}
