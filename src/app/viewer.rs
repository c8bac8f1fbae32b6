//! The event loop: opens the session when the window system is ready, passes events on, and closes it in order.

use super::error::AppError;
use super::session::Session;
use super::tracer::Word;
use super::{AppExit, AppOptions, display};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::window::WindowId;

/// See [`run`](super::run).
pub fn run(options: AppOptions) -> Result<AppExit, AppError> {
    let event_loop = display::event_loop()?;
    let end = AppExit { camera: options.camera, settings: options.settings.clone(), warnings: Vec::new() };
    let mut viewer = Viewer {
        options,
        proxy: event_loop.create_proxy(),
        frame_announced: Arc::new(AtomicBool::new(false)),
        session: None,
        end: Ok(end),
    };
    event_loop.run_app(&mut viewer)?;
    viewer.end
}

struct Viewer {
    options: AppOptions,
    proxy: EventLoopProxy<Word>,
    /// A frame was announced and not yet fetched: the next needs no announcement.
    frame_announced: Arc<AtomicBool>,
    session: Option<Session>,
    end: Result<AppExit, AppError>,
}

impl Viewer {
    fn open(&self, event_loop: &ActiveEventLoop) -> Result<Session, AppError> {
        let proxy = self.proxy.clone();
        let announced = self.frame_announced.clone();
        let word = move |word| {
            if word == Word::Gone || !announced.swap(true, Ordering::AcqRel) {
                // Without an event loop there is no one left to tell.
                let _ = proxy.send_event(word);
            }
        };
        Session::open(event_loop, &self.options, word)
    }

    /// Closes the window; the session ends in [`exiting`](ApplicationHandler::exiting).
    fn close(&mut self, event_loop: &ActiveEventLoop, error: Option<AppError>) {
        if let Some(error) = error {
            self.end = Err(error);
        }
        event_loop.exit();
    }
}

impl ApplicationHandler<Word> for Viewer {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.session.is_none() {
            match self.open(event_loop) {
                Ok(session) => self.session = Some(session),
                Err(error) => self.close(event_loop, Some(error)),
            }
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, word: Word) {
        match word {
            Word::Frame => {
                self.frame_announced.store(false, Ordering::Release);
                if let Some(session) = &mut self.session {
                    session.fetch_frame();
                }
            }
            Word::Gone => self.close(event_loop, Some(AppError::TracerGone)),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        let Some(session) = &mut self.session else { return };
        if event == WindowEvent::CloseRequested {
            return self.close(event_loop, None);
        }
        match session.on_window_event(&event) {
            Ok(true) => self.close(event_loop, None),
            Ok(false) => {}
            Err(error) => self.close(event_loop, Some(error)),
        }
    }

    fn device_event(&mut self, _event_loop: &ActiveEventLoop, _device: DeviceId, event: DeviceEvent) {
        if let (Some(session), DeviceEvent::MouseMotion { delta }) = (&mut self.session, event) {
            session.on_device_motion(delta.into());
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let next = self.session.as_mut().and_then(|session| session.tick(Instant::now()));
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }

    fn exiting(&mut self, _event_loop: &ActiveEventLoop) {
        // Here and not later: the window must go while the event loop is still there.
        if let Some(session) = self.session.take()
            && let Ok(end) = &mut self.end
        {
            *end = session.close();
        }
    }
}
