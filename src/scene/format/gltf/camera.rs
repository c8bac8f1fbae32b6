//! Cameras at their nodes.

use super::document::{Document, get};
use super::fault::{Read, Report};
use super::nodes::Nodes;
use crate::geometry::Aabb;
use crate::scene::Camera;
use crate::scene::desc::CameraDesc;
use glam::{DAffine3, DVec3};
use gltf::json::camera::{Orthographic, Type};
use gltf::json::validation::Checked;
use std::cell::LazyCell;

/// The cameras of the scene, in the order of its nodes. `bounds` tells those of what they look at.
///
/// Their clipping planes are left out: they say what a rasteriser can resolve, not what there is to see.
pub fn cameras(
    document: &Document,
    nodes: &Nodes,
    bounds: impl Fn() -> Aabb,
    report: &mut Report,
) -> Read<Vec<CameraDesc>> {
    let mut cameras: Vec<CameraDesc> = Vec::new();
    let bounds = LazyCell::new(bounds);
    for &node in &nodes.order {
        let Some(own) = &document.root.nodes[node] else { continue };
        let (Some(index), Some(world)) = (own.camera, &nodes.worlds[node]) else { continue };
        let named = get(&document.root.cameras, index, "camera", format_args!("/nodes/{node}/camera"));
        let Some(named) = report.attempt(named, "cameras left out")? else { continue };
        let pointer = format!("/cameras/{}", index.value());
        let (eye, forward, up) = pose(world);
        let fov = match (&named.type_, &named.perspective, &named.orthographic) {
            (Checked::Valid(Type::Perspective), Some(perspective), _) => f64::from(perspective.yfov).to_degrees(),
            (Checked::Valid(Type::Orthographic), _, Some(orthographic)) => {
                report.warn(&pointer, "an orthographic camera; its view is shown in perspective");
                fov_of(orthographic, eye, forward, *bounds)
            }
            _ => {
                let message = "expected type perspective or orthographic, and an entry of that name; left out";
                report.warn(pointer, message);
                continue;
            }
        };
        // Far from the origin a point one metre away would round to a coarse direction.
        let reach = eye.abs().max_element().max(1.0);
        let look_at = eye + forward * reach;
        let camera = Camera {
            eye: eye.as_vec3(),
            look_at: look_at.as_vec3(),
            up: up.as_vec3(),
            fov: fov as f32,
            ..Camera::default()
        };
        if !camera.is_valid() {
            report.warn(&pointer, "the camera sees nothing: its yfov or its node is of no use; left out");
            continue;
        }
        let name = named.name.clone().or_else(|| own.name.clone());
        let name = name.unwrap_or_else(|| format!("camera {}", cameras.len()));
        cameras.push(CameraDesc { at: report.at(&*pointer), name, eye, look_at, camera });
    }
    Ok(cameras)
}

/// Position, view and up of a node; it looks along its -z axis.
fn pose(world: &DAffine3) -> (DVec3, DVec3, DVec3) {
    let forward = -world.matrix3.z_axis.normalize_or_zero();
    (world.translation, forward, world.matrix3.y_axis.normalize_or_zero())
}

/// The vertical field of view, in degrees, that shows of the scene's middle as much as an orthographic camera does.
fn fov_of(orthographic: &Orthographic, eye: DVec3, forward: DVec3, bounds: Aabb) -> f64 {
    let distance = match bounds.is_empty() {
        true => 0.0,
        false => ((bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0 - eye).dot(forward),
    };
    let [near, far] = [orthographic.znear, orthographic.zfar].map(f64::from);
    let distance = if distance > near { distance } else { (near + far) / 2.0 };
    let half = libm::atan2(f64::from(orthographic.ymag).abs(), distance);
    (2.0 * half).to_degrees().clamp(1.0, 150.0)
}
