//! Makes a failing scene file as small and plain as it can be while it still fails.

use serde_json::{Value, json};

/// Shrinks `scene` while `fails` holds, trying at most `tries` smaller ones.
pub fn shrink(mut scene: Value, tries: usize, fails: &mut dyn FnMut(&Value) -> bool) -> Value {
    let mut left = tries;
    let mut attempt = |scene: &mut Value, smaller: Value| {
        let better = left > 0 && smaller != *scene && {
            left -= 1;
            fails(&smaller)
        };
        if better {
            *scene = smaller;
        }
        better
    };
    loop {
        let before = scene.clone();
        for list in ["/lights", "/objects"] {
            shrink_list(&mut scene, list, &mut attempt);
        }
        for at in 0..count(&scene, "/objects") {
            shrink_list(&mut scene, &format!("/objects/{at}/triangles"), &mut attempt);
            shrink_list(&mut scene, &format!("/objects/{at}/children"), &mut attempt);
        }
        for key in keys(&scene) {
            remove(&mut scene, &key, &mut attempt);
        }
        for (path, value) in
            [("/render/max_depth", json!(1)), ("/render/width", json!(8)), ("/render/height", json!(8))]
        {
            replace(&mut scene, path, value, &mut attempt);
        }
        for path in numbers(&scene, String::new()) {
            simplify(&mut scene, &path, &mut attempt);
        }
        if scene == before {
            return scene;
        }
    }
}

/// Tries a smaller scene, and takes it where it fails as well.
type Attempt<'a> = dyn FnMut(&mut Value, Value) -> bool + 'a;

fn count(scene: &Value, path: &str) -> usize {
    scene.pointer(path).and_then(Value::as_array).map_or(0, Vec::len)
}

/// Leaves out halves of a list, then quarters, down to single entries.
fn shrink_list(scene: &mut Value, path: &str, attempt: &mut Attempt<'_>) {
    let mut chunk = count(scene, path).div_ceil(2);
    while chunk > 0 {
        let mut start = 0;
        while start < count(scene, path) {
            let mut smaller = scene.clone();
            if let Some(list) = smaller.pointer_mut(path).and_then(Value::as_array_mut) {
                list.drain(start..(start + chunk).min(list.len()));
            }
            if !attempt(scene, smaller) {
                start += chunk;
            }
        }
        chunk /= 2;
    }
}

/// Pointers to what a file may lack: everything in a map, but for what says how large the picture is.
fn keys(scene: &Value) -> Vec<String> {
    let mut all = Vec::new();
    let mut open = vec![(String::new(), scene)];
    while let Some((path, value)) = open.pop() {
        match value {
            Value::Object(map) => open.extend(map.iter().map(|(key, value)| {
                let path = format!("{path}/{key}");
                all.push(path.clone());
                (path, value)
            })),
            Value::Array(list) => open.extend(list.iter().enumerate().map(|(i, v)| (format!("{path}/{i}"), v))),
            _ => {}
        }
    }
    all.retain(|path| !["/version", "/render", "/render/width", "/render/height"].contains(&path.as_str()));
    all
}

fn remove(scene: &mut Value, path: &str, attempt: &mut Attempt<'_>) {
    let mut smaller = scene.clone();
    let (parent, key) = path.rsplit_once('/').unwrap_or_default();
    if let Some(map) = smaller.pointer_mut(parent).and_then(Value::as_object_mut)
        && map.remove(key).is_some()
    {
        attempt(scene, smaller);
    }
}

fn replace(scene: &mut Value, path: &str, value: Value, attempt: &mut Attempt<'_>) -> bool {
    let mut smaller = scene.clone();
    match smaller.pointer_mut(path) {
        Some(place) => *place = value,
        None => return false,
    }
    attempt(scene, smaller)
}

/// Pointers to numbers that need not be what they are.
fn numbers(value: &Value, path: String) -> Vec<String> {
    match value {
        Value::Number(number) if number.as_f64().is_some_and(|n| n != 0.0) => vec![path],
        Value::Array(list) => {
            let inner = list.iter().enumerate().map(|(i, v)| numbers(v, format!("{path}/{i}")));
            inner.flatten().collect()
        }
        Value::Object(map) => {
            let kept = |key: &str| ["version", "triangles"].contains(&key);
            let inner = map.iter().filter(|(key, _)| !kept(key)).map(|(key, v)| numbers(v, format!("{path}/{key}")));
            inner.flatten().collect()
        }
        _ => Vec::new(),
    }
}

/// Rounds a number as far as it goes: to 0, to 1, or to few digits.
fn simplify(scene: &mut Value, path: &str, attempt: &mut Attempt<'_>) {
    let Some(number) = scene.pointer(path).and_then(Value::as_f64) else { return };
    let whole = scene.pointer(path).is_some_and(|n| n.is_u64());
    let written = |digits: usize| format!("{number:.digits$e}").parse::<f64>().unwrap_or(number);
    let simpler = [0.0, 1.0, -1.0].into_iter().chain([0, 1, 3, 5, 8].map(written));
    for value in
        simpler.filter(|value| value.to_string().len() < number.to_string().len() || value.abs() < number.abs())
    {
        let value = if whole { json!(value as u64) } else { json!(value) };
        if replace(scene, path, value, attempt) {
            return;
        }
    }
}
