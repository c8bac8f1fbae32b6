//! The graphics device and the window's surface, and everything that can go wrong with them.

use std::sync::{Arc, Mutex, PoisonError};
use winit::dpi::PhysicalSize;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

/// What is tried, best first. GL comes apart: an instance with both would make two surfaces on one window.
const BACKENDS: [wgpu::Backends; 2] = [wgpu::Backends::PRIMARY, wgpu::Backends::GL];

/// Adapter, device and surface of one window.
#[derive(Debug)]
pub struct Gpu {
    /// Creates textures and pipelines.
    pub device: wgpu::Device,
    /// Takes uploads and commands.
    pub queue: wgpu::Queue,
    /// The adapter computes on the CPU, and takes that time from the tracer.
    pub is_software: bool,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    fault: Fault,
    window: Arc<Window>,
}

/// The first thing that wgpu reported outside of a call. Unhandled it would panic.
#[derive(Clone, Debug, Default)]
struct Fault(Arc<Mutex<Option<String>>>);

impl Fault {
    fn report(&self, what: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(what);
    }
}

/// What the surface has for us to draw on.
#[derive(Debug)]
pub enum Target {
    /// A texture to draw on and to [present](Gpu::present).
    Ready(wgpu::SurfaceTexture),
    /// Nothing now; the next drawing will do.
    Later,
    /// The device is gone, for this reason.
    Lost(String),
}

impl Gpu {
    /// Finds an adapter that can show on `window`.
    ///
    /// # Errors
    /// What each backend said, in one line.
    pub fn new(window: &Arc<Window>, display: &OwnedDisplayHandle) -> Result<Self, String> {
        let mut reasons = Vec::new();
        for backends in BACKENDS {
            match Self::with_backends(backends, window, display) {
                Ok(gpu) => return Ok(gpu),
                Err(reason) => reasons.push(one_line(&reason)),
            }
        }
        reasons.dedup();
        Err(reasons.join("; "))
    }

    fn with_backends(
        backends: wgpu::Backends,
        window: &Arc<Window>,
        display: &OwnedDisplayHandle,
    ) -> Result<Self, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_with_display_handle(Box::new(display.clone()))
        });
        let surface = instance.create_surface(window.clone()).map_err(|error| error.to_string())?;
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            // One blit a frame is no reason to wake the big GPU.
            power_preference: wgpu::PowerPreference::LowPower,
            compatible_surface: Some(&surface),
            ..Default::default()
        }))
        .map_err(|error| error.to_string())?;
        let limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits());
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("raywalk"),
            required_limits: limits,
            ..Default::default()
        }))
        .map_err(|error| error.to_string())?;
        let fault = Fault::default();
        let (uncaptured, lost) = (fault.clone(), fault.clone());
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| uncaptured.report(error.to_string())));
        device.set_device_lost_callback(move |reason, message| lost.report(format!("{reason:?} {message}")));
        let config =
            configuration(&surface.get_capabilities(&adapter)).ok_or("the adapter cannot show on the window")?;
        let is_software = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let mut gpu = Self { device, queue, is_software, instance, surface, config, fault, window: window.clone() };
        gpu.resize(window.inner_size());
        Ok(gpu)
    }

    /// The format of the surface's textures.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Largest side of a texture in pixels.
    pub fn max_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Size of what [`acquire`](Self::acquire) returns; zero while the window is minimised.
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// The window has a new size.
    pub fn resize(&mut self, size: PhysicalSize<u32>) {
        self.config.width = size.width.min(self.max_side());
        self.config.height = size.height.min(self.max_side());
        self.configure();
    }

    fn configure(&self) {
        // Configuring to nothing panics; a minimised window is configured when it comes back.
        if self.config.width > 0 && self.config.height > 0 {
            self.surface.configure(&self.device, &self.config);
        }
    }

    /// Something to draw on, if the window is there to be drawn on.
    pub fn acquire(&mut self) -> Target {
        if let Some(reason) = self.fault.0.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Target::Lost(one_line(&reason));
        }
        if self.config.width == 0 || self.config.height == 0 {
            return Target::Later;
        }
        use wgpu::CurrentSurfaceTexture as Current;
        match self.surface.get_current_texture() {
            Current::Success(texture) | Current::Suboptimal(texture) => Target::Ready(texture),
            Current::Timeout | Current::Occluded | Current::Validation => Target::Later,
            Current::Outdated => {
                self.configure();
                Target::Later
            }
            Current::Lost => match self.instance.create_surface(self.window.clone()) {
                Ok(surface) => {
                    self.surface = surface;
                    self.configure();
                    Target::Later
                }
                Err(error) => Target::Lost(one_line(&error.to_string())),
            },
        }
    }

    /// Whether the surface's textures can be written to without drawing.
    pub fn can_copy_to_surface(&self) -> bool {
        self.config.usage.contains(wgpu::TextureUsages::COPY_DST)
    }

    /// Submits what was drawn or written, and shows it.
    pub fn present(&self, commands: Option<wgpu::CommandBuffer>, texture: wgpu::SurfaceTexture) {
        self.queue.submit(commands);
        self.window.pre_present_notify();
        self.queue.present(texture);
    }
}

/// How to set the surface up; `None` when it cannot be drawn on.
fn configuration(capabilities: &wgpu::SurfaceCapabilities) -> Option<wgpu::SurfaceConfiguration> {
    // Formats that store bytes as they come need no decoding; sRGB ones work too.
    let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    let format = plain.into_iter().find(|format| capabilities.formats.contains(format));
    let format = format.or_else(|| capabilities.formats.first().copied())?;
    // The pace is our own: waiting for the display here would hold up input.
    let modes = [wgpu::PresentMode::Mailbox, wgpu::PresentMode::Fifo];
    let present_mode = modes.into_iter().find(|mode| capabilities.present_modes.contains(mode))?;
    Some(wgpu::SurfaceConfiguration {
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | (capabilities.usages & wgpu::TextureUsages::COPY_DST),
        format,
        color_space: wgpu::SurfaceColorSpace::Auto,
        width: 0,
        height: 0,
        present_mode,
        desired_maximum_frame_latency: 2,
        alpha_mode: wgpu::CompositeAlphaMode::Auto,
        view_formats: Vec::new(),
    })
}

/// A message of wgpu's without its line breaks and its empty list of details.
fn one_line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    line.trim_end_matches(": {}").to_owned()
}
