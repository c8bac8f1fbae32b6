//! The event loop: opens the session when the window system is ready, passes events on, and closes it in order.

use super::error::AppError;
use super::session::Session;
use super::tracer::Word;
use super::{AppExit, AppOptions, Closer, display};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::window::WindowId;

/// What other threads wake the event loop for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call {
    /// The tracer has word.
    Traced(Word),
    /// There may be news of scenes.
    Scenes,
    /// There is news of an errand.
    Errand,
    /// The window has to close.
    Close,
}

/// See [`run`](super::run).
pub fn run(options: AppOptions, closer: impl FnOnce(Closer)) -> Result<AppExit, AppError> {
    let event_loop = display::event_loop()?;
    let proxy = event_loop.create_proxy();
    closer(Box::new(move || proxy.send_event(Call::Close).is_ok()));
    let mut viewer = Viewer {
        options,
        proxy: event_loop.create_proxy(),
        frame_announced: Arc::new(AtomicBool::new(false)),
        session: None,
        end: None,
    };
    event_loop.run_app(&mut viewer)?;
    viewer.end.unwrap_or_else(|| Err(AppError::NoDisplay("the window system gave no chance to open one".to_owned())))
}

struct Viewer {
    options: AppOptions,
    proxy: EventLoopProxy<Call>,
    /// A frame was announced and not yet fetched: the next needs no announcement.
    frame_announced: Arc<AtomicBool>,
    session: Option<Session>,
    end: Option<Result<AppExit, AppError>>,
}

impl Viewer {
    fn open(&self, event_loop: &ActiveEventLoop) -> Result<Session, AppError> {
        // Not every system lets threads share a proxy.
        let proxy = Mutex::new(self.proxy.clone());
        let announced = self.frame_announced.clone();
        let call = move |call| {
            if call != Call::Traced(Word::Frame) || !announced.swap(true, Ordering::AcqRel) {
                // Without an event loop there is no one left to tell.
                let _ = proxy.lock().unwrap_or_else(PoisonError::into_inner).send_event(call);
            }
        };
        Session::open(event_loop, &self.options, Arc::new(call))
    }

    /// Closes the window; the session ends in [`exiting`](ApplicationHandler::exiting).
    fn close(&mut self, event_loop: &ActiveEventLoop, error: Option<AppError>) {
        if let Some(error) = error {
            self.end = Some(Err(error));
        }
        event_loop.exit();
    }
}

impl ApplicationHandler<Call> for Viewer {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.session.is_none() {
            match self.open(event_loop) {
                Ok(session) => self.session = Some(session),
                Err(error) => self.close(event_loop, Some(error)),
            }
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, call: Call) {
        match call {
            Call::Traced(Word::Frame) => {
                self.frame_announced.store(false, Ordering::Release);
                if let Some(session) = &mut self.session {
                    session.fetch_frame();
                }
            }
            Call::Traced(Word::Gone) => self.close(event_loop, Some(AppError::TracerGone)),
            Call::Errand => {
                if let Some(session) = &mut self.session {
                    session.tell_news(Instant::now());
                }
            }
            Call::Close => self.close(event_loop, None),
            Call::Scenes => {
                if let Some(Err(error)) = self.session.as_mut().map(Session::on_news) {
                    self.close(event_loop, Some(error));
                }
            }
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
        if let Some(session) = self.session.take() {
            let end = session.close();
            self.end.get_or_insert(Ok(end));
        }
    }
}
