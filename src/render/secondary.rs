//! The rays that follow from hits: mirrored, and refracted by Snell's law with exact Fresnel terms.

use super::brdf;
use super::contact::{ContactArena, NO_CONTACT, Touching};
use super::frame::Frame;
use super::gather::{Hits, bits};
use super::leave;
use super::materials::Materials;
use super::media::{Media, MediaList, OUTSIDE};
use super::queue::{Lineage, MOST_LANES, RayQueue};
use super::skin::Skin;
use super::stats::RayCounts;
use super::tables::Row;
use crate::geometry::NO_PRIMITIVE;
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// A packet of rays at the surfaces that they hit.
pub(super) struct Incident<'a, S: Simd> {
    /// The lanes whose surfaces mirror or refract.
    pub spawning: Mask<S>,
    pub direction: V3<S::f32s>,
    pub position: V3<S::f32s>,
    /// Unit geometric normal on the side where the ray came from.
    pub facing: V3<S::f32s>,
    /// How far off the surface rays start.
    pub margin: S::f32s,
    /// Unit shading normal on that side.
    pub normal: V3<S::f32s>,
    /// The ray came from inside of the object.
    pub from_behind: Mask<S>,
    /// What the surface is like.
    pub skin: &'a Skin<S>,
    pub weight: V3<S::f32s>,
    pub sample: S::u32s,
    pub media: S::u32s,
    /// What touches the surfaces, if anything does.
    pub touching: Option<&'a Touching<S>>,
    /// The primitive, where it is flat; else [`NO_PRIMITIVE`].
    pub flat: S::u32s,
    /// How long the way from the eye is.
    pub way: S::f32s,
}

impl<S: Simd> Incident<'_, S> {
    /// What rays that follow belong to.
    #[inline(always)]
    fn lineage(&self, media: S::u32s, contact: Option<S::u32s>, source: S::u32s) -> Lineage<S> {
        Lineage { sample: self.sample, media, contact, source, way: self.way }
    }
}

/// What share of the light is mirrored and refracted, and where to.
struct Split<S: Simd> {
    reflected: V3<S::f32s>,
    refracted: V3<S::f32s>,
    /// Direction of the refracted ray; meaningless where its share is 0.
    inward: V3<S::f32s>,
}

/// The transparent objects of a packet's hits.
struct Transparent {
    /// Bit set of the lanes with one.
    lanes: u64,
    /// Of these, the ones that bound a body; light does not bend at thin ones.
    bodies: u64,
    /// The object of each of these lanes.
    objects: [u32; MOST_LANES],
}

/// Queues mirrored and refracted rays, each if it is wanted and weighs enough.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "parts of the worker and of the packet, borrowed apart")]
pub(super) fn follow<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    materials: &impl Materials<S>,
    incident: &Incident<'_, S>,
    media: &mut Media,
    contacts: &ContactArena,
    [mirrored, refracted]: [&mut RayQueue; 2],
    counts: &mut RayCounts,
) {
    // With a shading normal that leans away, the ray may graze it from behind.
    let cosine = (-incident.direction.dot(incident.normal)).max(0.0);
    let transparent = Transparent::new(simd, frame, hits, materials, incident.spawning.to_bitmask());
    let mut interface = None;
    let mut split = Split::<S> {
        reflected: mirror_share(simd, frame, materials, incident.skin, cosine),
        refracted: V3::zero(simd),
        inward: incident.direction,
    };
    if transparent.lanes != 0 {
        let index = outside_index(simd, frame, incident, &transparent, media);
        if let Some(touching) = incident.touching {
            interface = Interface::new(simd, frame, incident, &transparent, touching.links, contacts, media);
        }
        let through = refract(simd, frame, materials, incident, cosine, index, interface.as_ref(), transparent.bodies);
        let lanes = Mask::<S>::from_bitmask(simd, transparent.lanes);
        split.reflected = V3::select(lanes, through.reflected, split.reflected);
        split.refracted = V3::select(lanes, through.refracted, split.refracted);
        split.inward = through.inward;
    }
    let mut tint = incident.skin.color;
    if frame.plan.blending && materials.any(|material| material.blended) {
        // Straight on, as if nothing were there, for what the surface does not cover.
        let coverage = incident.skin.coverage;
        let one = S::f32s::splat(simd, 1.0);
        let blended = materials.lanes(simd, |material| material.blended);
        split.reflected = V3::select(blended, split.reflected.scale(coverage), split.reflected);
        split.refracted = V3::select(blended, V3::all(one - coverage), split.refracted);
        split.inward = V3::select(blended, incident.direction, split.inward);
        tint = V3::select(blended, V3::all(one), tint);
    }

    if frame.plan.reflections {
        let mut weight = incident.weight * split.reflected;
        if let Some(touching) = incident.touching {
            weight = weight * touching.filter;
        }
        let heavy = incident.spawning & heavy(simd, weight, frame.settings.min_weight);
        if heavy.any_true() {
            let direction = hold_unit::<S>(incident.direction + incident.normal.scale(cosine * 2.0));
            let start = leave::start::<S>(incident.position, incident.facing, incident.margin, direction);
            let contact = frame.plan.contacts.then(|| S::u32s::splat(simd, NO_CONTACT));
            let lineage = incident.lineage(incident.media, contact, incident.flat);
            mirrored.push_lanes::<S>(heavy, start, direction, weight, &lineage);
            counts.reflection += u64::from(heavy.to_bitmask().count_ones());
        }
    }
    if frame.plan.refractions && transparent.lanes != 0 {
        let mut weight = incident.weight * (split.refracted * tint);
        if let Some(touching) = incident.touching {
            weight = weight * contacts.tint(simd, frame, touching.links, [incident.position, incident.direction]);
        }
        let heavy = incident.spawning & heavy(simd, weight, frame.settings.min_weight);
        if heavy.any_true() {
            let crossing = heavy.to_bitmask() & transparent.bodies;
            let mut inside = if frame.plan.media && crossing != 0 {
                cross(simd, incident, &transparent.objects, crossing, media)
            } else {
                incident.media
            };
            if let Some(interface) = &interface {
                inside = interface.lanes.select(interface.media, inside);
            }
            let start = leave::start::<S>(incident.position, -incident.facing, incident.margin, split.inward);
            let nothing = S::u32s::splat(simd, NO_PRIMITIVE);
            let contact = frame.plan.contacts.then(|| match incident.touching {
                Some(touching) => S::u32s::from_fn(simd, |lane| contacts.next(touching.links.as_slice()[lane])),
                None => S::u32s::splat(simd, NO_CONTACT),
            });
            refracted.push_lanes::<S>(heavy, start, split.inward, weight, &incident.lineage(inside, contact, nothing));
            counts.refraction += u64::from(heavy.to_bitmask().count_ones());
        }
    }
}

/// Faces of several bodies in one place: light bends once.
struct Interface<S: Simd> {
    /// The lanes that meet such a place.
    lanes: Mask<S>,
    /// Indices of refraction before and behind it.
    indices: [S::f32s; 2],
    /// The bodies that a ray is inside of behind it.
    media: S::u32s,
}

impl<S: Simd> Interface<S> {
    #[inline(never)]
    fn new(
        simd: S,
        frame: &Frame<'_>,
        incident: &Incident<'_, S>,
        transparent: &Transparent,
        links: S::u32s,
        contacts: &ContactArena,
        media: &mut Media,
    ) -> Option<Self> {
        let mut found: Option<Self> = None;
        let leaving = incident.from_behind.to_bitmask();
        for lane in bits(transparent.bodies) {
            let faces = contacts.faces(links.as_slice()[lane]);
            if faces.is_empty() {
                continue;
            }
            let before = incident.media.as_slice()[lane];
            let first = media.cross(before, transparent.objects[lane], leaving >> lane & 1 == 1);
            let list = faces.iter().fold(first, |list, face| media.cross(list, face.object, face.leaves));
            let index = |list: MediaList| media.current(list).map_or(1.0, |body| frame.scene.material_of(body).ior);
            let indices = [index(before), index(list)];
            let interface = found.get_or_insert_with(|| Self {
                lanes: Mask::<S>::splat(simd, false),
                indices: [S::f32s::splat(simd, 1.0); 2],
                media: incident.media,
            });
            interface.lanes.set(lane, true);
            for (lanes, index) in interface.indices.iter_mut().zip(indices) {
                lanes.as_mut_slice()[lane] = index;
            }
            interface.media.as_mut_slice()[lane] = list;
        }
        found
    }
}

/// Takes the rounding off the length of vectors that are all but unit: one step of Newton's method for 1/sqrt from 1.
#[inline(always)]
fn hold_unit<S: Simd>(v: V3<S::f32s>) -> V3<S::f32s> {
    v.scale(S::f32s::splat(v.x.token(), 1.5) - v.dot(v) * 0.5)
}

impl Transparent {
    #[inline(always)]
    fn new<S: Simd>(simd: S, frame: &Frame<'_>, hits: &Hits<'_>, materials: &impl Materials<S>, spawning: u64) -> Self {
        let mut found = Self { lanes: 0, bodies: 0, objects: [0; MOST_LANES] };
        if !frame.plan.coloured_shadows {
            return found;
        }
        found.lanes = materials.lanes(simd, |material| material.transparent).to_bitmask() & spawning;
        if found.lanes == 0 {
            return found;
        }
        let (geometry, objects) = (&frame.scene.geometry, &frame.scene.objects);
        if let Some(primitive) = hits.common {
            let object = geometry.object_of(primitive);
            found.objects = [object; MOST_LANES];
            found.bodies = if objects[object as usize].body { found.lanes } else { 0 };
        } else {
            for lane in bits(found.lanes) {
                let object = geometry.object_of(hits.primitives[lane]);
                found.objects[lane] = object;
                found.bodies |= u64::from(objects[object as usize].body) << lane;
            }
        }
        found
    }
}

/// Which rays are worth tracing: those without weight never are.
#[inline(always)]
fn heavy<S: Simd>(simd: S, weight: V3<S::f32s>, min_weight: f32) -> Mask<S> {
    let largest = weight.x.max(weight.y).max(weight.z);
    largest.simd_gt(S::f32s::splat(simd, 0.0)) & largest.simd_ge(S::f32s::splat(simd, min_weight))
}

/// Index of refraction outside of the transparent objects hit: that of the body around, 1 where there is none.
#[inline(always)]
fn outside_index<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    incident: &Incident<'_, S>,
    transparent: &Transparent,
    media: &Media,
) -> S::f32s {
    let mut index = S::f32s::splat(simd, 1.0);
    let within = transparent.lanes & incident.media.simd_ne(S::u32s::splat(simd, OUTSIDE)).to_bitmask();
    for_each_list(
        simd,
        incident,
        &transparent.objects,
        within,
        #[inline(always)]
        |list, object, lanes| {
            if let Some(around) = media.around(list, object) {
                index = lanes.select(S::f32s::splat(simd, frame.scene.material_of(around).ior), index);
            }
        },
    );
    index
}

/// Shares and directions at transparent surfaces in surroundings of index `outside`. Only at `bodies` the ray bends.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what is known of one packet, some of it at compile time")]
fn refract<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    materials: &impl Materials<S>,
    incident: &Incident<'_, S>,
    cosine: S::f32s,
    outside: S::f32s,
    interface: Option<&Interface<S>>,
    bodies: u64,
) -> Split<S> {
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let bends = Mask::<S>::from_bitmask(simd, bodies);
    let inside = materials.row(simd, Row::Ior as usize);
    let leaving = incident.from_behind & bends;
    // The index on the side where the ray comes from, divided by that on the other side.
    let mut indices = [leaving.select(inside, outside), leaving.select(outside, inside)];
    if let Some(interface) = interface {
        for (index, own) in indices.iter_mut().zip(interface.indices) {
            *index = interface.lanes.select(own, *index);
        }
    }
    let eta = indices[0] / indices[1];

    let passing = one - eta * eta * (one - cosine * cosine);
    let total = passing.simd_lt(zero) & bends;
    let cosine_inward = passing.max(0.0).sqrt();
    let fresnel = materials.lanes(simd, |material| material.fresnel);
    let mirrored = fresnel.select(dielectric_fresnel::<S>(cosine, cosine_inward, eta), zero);
    let mirrored = total.select(one, mirrored);

    let bent = incident.direction.scale(eta) + incident.normal.scale(eta * cosine - cosine_inward);
    let mut transparency = materials.triple(simd, Row::Transparency);
    if frame.plan.textures {
        transparency = transparency.scale(incident.skin.transmission);
    }
    Split {
        reflected: materials.triple(simd, Row::Reflectivity) + transparency.scale(mirrored),
        refracted: transparency.scale(one - mirrored),
        inward: V3::select(bends, bent.normalize(), incident.direction),
    }
}

/// Exact reflectance of unpolarised light between dielectrics; `eta` is the index in front divided by that behind.
#[inline(always)]
fn dielectric_fresnel<S: Simd>(cosine_in: S::f32s, cosine_out: S::f32s, eta: S::f32s) -> S::f32s {
    let zero = S::f32s::splat(eta.token(), 0.0);
    let across = (eta * cosine_in - cosine_out) / (eta * cosine_in + cosine_out);
    let along = (cosine_in - eta * cosine_out) / (cosine_in + eta * cosine_out);
    // Along a surface with the same index on both sides there is nothing to reflect from.
    let flat = (cosine_in + cosine_out).simd_eq(zero);
    flat.select(zero, (across * across + along * along) * 0.5)
}

/// What opaque surfaces mirror: their reflectivity, or Schlick's term for metallic-roughness.
#[inline(always)]
fn mirror_share<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    materials: &impl Materials<S>,
    skin: &Skin<S>,
    cosine: S::f32s,
) -> V3<S::f32s> {
    let reflectivity = materials.triple(simd, Row::Reflectivity);
    if !(frame.plan.metallic_roughness && materials.any(|material| material.metallic_roughness)) {
        return reflectivity;
    }
    let fresnel = brdf::schlick(simd, skin.f0(simd, materials), cosine);
    V3::select(materials.lanes(simd, |material| material.metallic_roughness), fresnel, reflectivity)
}

/// The bodies that rays are inside of once those in the bit set `crossing` entered or left their objects.
#[inline(always)]
fn cross<S: Simd>(
    simd: S,
    incident: &Incident<'_, S>,
    objects: &[u32; MOST_LANES],
    crossing: u64,
    media: &mut Media,
) -> S::u32s {
    let mut inside = incident.media;
    let leaving = incident.from_behind.to_bitmask();
    for (crossing, leaves) in [(crossing & leaving, true), (crossing & !leaving, false)] {
        for_each_list(
            simd,
            incident,
            objects,
            crossing,
            #[inline(always)]
            |list, object, lanes| {
                let next = media.cross(list, object, leaves);
                inside = lanes.select(S::u32s::splat(simd, next), inside);
            },
        );
    }
    inside
}

/// Calls `visit` for each list of bodies and each object that some of `lanes` share, with those lanes. Rays that share
/// their history and their object share the list: mostly, that is the whole packet.
#[inline(always)]
fn for_each_list<S: Simd>(
    simd: S,
    incident: &Incident<'_, S>,
    objects: &[u32; MOST_LANES],
    lanes: u64,
    mut visit: impl FnMut(MediaList, u32, Mask<S>),
) {
    let (lists, all_objects) = (incident.media, S::u32s::from_slice(simd, &objects[..S::f32s::LEN]));
    let mut left = lanes;
    while left != 0 {
        let lane = left.trailing_zeros() as usize % MOST_LANES;
        let (list, object) = (lists.as_slice()[lane], objects[lane]);
        let same = lists.simd_eq(list).to_bitmask() & all_objects.simd_eq(object).to_bitmask() & left;
        left &= !same;
        visit(list, object, Mask::<S>::from_bitmask(simd, same));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{SimdToken, dispatch};

    fn lanes<S: Simd>(simd: S, [cosine_in, cosine_out, eta]: [f32; 3]) -> f32 {
        let splat = |value| S::f32s::splat(simd, value);
        dielectric_fresnel::<S>(splat(cosine_in), splat(cosine_out), splat(eta))[0]
    }

    #[test]
    fn fresnel_at_normal_incidence_and_at_grazing() {
        let fresnel = |terms: [f32; 3]| dispatch!(SimdToken::best(), simd => lanes(simd, terms));
        assert!((fresnel([1.0, 1.0, 1.0 / 1.5]) - 0.04).abs() < 1e-6);
        assert!((fresnel([1.0, 1.0, 1.5]) - 0.04).abs() < 1e-6);
        let grazing = (1.0_f32 - 1.0 / 2.25).sqrt();
        assert!(fresnel([1e-4, grazing, 1.0 / 1.5]) > 0.999);
        assert_eq!(fresnel([0.5, 0.5, 1.0]), 0.0);
        assert_eq!(fresnel([0.0, 0.0, 1.0]), 0.0);
    }
}
