//! What a frame cost, and how its pixels were obtained.

use serde::Serialize;

/// Rays really traced, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Mirrored.
    pub reflection: u64,
    /// Refracted.
    pub refraction: u64,
}

/// How pixels were obtained; they add up to the picture's size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PixelCounts {
    /// A ray of their own.
    pub traced: u64,
    /// From a candidate list or a known primitive.
    pub resolved: u64,
    /// Proven by their block.
    pub certified: u64,
    /// Interpolated from neighbours.
    pub interpolated: u64,
}

/// CPU milliseconds by stage, summed over threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageTimes {
    /// Finding what each pixel sees.
    pub visibility: f64,
    /// Proving that nothing was missed.
    pub certificate: f64,
    /// Shadow rays.
    pub shadow: f64,
    /// Shading.
    pub shade: f64,
    /// Tracing reflected and refracted rays.
    pub secondary: f64,
    /// Tone map and encoding.
    pub resolve: f64,
    /// Showing the frame (window only).
    pub present: f64,
}

/// How often the last blocker answered a shadow ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CacheCounts {
    /// Shadow rays that asked the cache.
    pub queries: u64,
    /// Of these, blocked by the cached object.
    pub hits: u64,
}

/// What beams told without a ray, and where they told too little.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CertificateCounts {
    /// Pixels that were tested against candidates although all of their area saw one thing: refused in vain.
    pub refused: u64,
    /// Shadow rays that were known to arrive.
    pub lit: u64,
    /// Shadow rays that were known not to.
    pub dark: u64,
    /// Mirrored rays that were tested against candidates alone.
    pub mirrored: u64,
}

/// What [`render_frame`](super::render_frame) reports.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrameStats {
    /// False when the frame was cancelled; its film is then a mix.
    pub completed: bool,
    /// Wall time of the frame in milliseconds.
    pub frame_ms: f64,
    /// Rays by kind.
    pub rays: RayCounts,
    /// Pixels by how they were obtained.
    pub pixels: PixelCounts,
    /// Pixels that got more than one ray.
    pub supersampled: u64,
    /// CPU time by stage.
    pub stages_ms: StageTimes,
    /// The shadow-object cache.
    pub shadow_cache: CacheCounts,
    /// Beams.
    pub certificates: CertificateCounts,
}

impl FrameStats {
    /// Adds another's counts and stage times; `completed` and `frame_ms` stay.
    pub fn add(&mut self, other: &Self) {
        let (rays, pixels, stages, cache) =
            (&mut self.rays, &mut self.pixels, &mut self.stages_ms, &mut self.shadow_cache);
        rays.primary += other.rays.primary;
        rays.shadow += other.rays.shadow;
        rays.reflection += other.rays.reflection;
        rays.refraction += other.rays.refraction;
        pixels.traced += other.pixels.traced;
        pixels.resolved += other.pixels.resolved;
        pixels.certified += other.pixels.certified;
        pixels.interpolated += other.pixels.interpolated;
        self.supersampled += other.supersampled;
        stages.visibility += other.stages_ms.visibility;
        stages.certificate += other.stages_ms.certificate;
        stages.shadow += other.stages_ms.shadow;
        stages.shade += other.stages_ms.shade;
        stages.secondary += other.stages_ms.secondary;
        stages.resolve += other.stages_ms.resolve;
        stages.present += other.stages_ms.present;
        self.certificates.refused += other.certificates.refused;
        self.certificates.lit += other.certificates.lit;
        self.certificates.dark += other.certificates.dark;
        self.certificates.mirrored += other.certificates.mirrored;
        cache.queries += other.shadow_cache.queries;
        cache.hits += other.shadow_cache.hits;
    }
}
