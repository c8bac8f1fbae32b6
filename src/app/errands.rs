//! Work for the disk that the event loop does not wait for: one thread, one errand after the other.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

/// What is done on the thread; it may have something to tell the user.
pub type Errand = Box<dyn FnOnce() -> Option<News> + Send>;

/// What came of an errand, in one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum News {
    /// It was done.
    Done(String),
    /// It could not be done.
    Problem(String),
}

/// The handle to the thread. Dropping it waits for the errands that were begun or asked for.
#[derive(Debug)]
pub struct Errands {
    errands: Option<Sender<Errand>>,
    news: Receiver<News>,
    thread: Option<JoinHandle<()>>,
}

impl Errands {
    /// Starts the thread, which calls `word` when there is news.
    ///
    /// # Errors
    /// The system's reason when no thread can be started.
    pub fn start(word: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (errands, asked) = channel::<Errand>();
        let (told, news) = channel();
        let thread = std::thread::Builder::new().name("errands".to_owned()).spawn(move || {
            for errand in asked {
                if let Some(news) = errand() {
                    // The last news may come when no one listens any more.
                    let _ = told.send(news);
                    word();
                }
            }
        })?;
        Ok(Self { errands: Some(errands), news, thread: Some(thread) })
    }

    /// Has an errand done after those before it.
    pub fn run(&self, errand: Errand) {
        if let Some(errands) = &self.errands {
            // It ends only when this handle goes, or an errand panicked, which was reported.
            let _ = errands.send(errand);
        }
    }

    /// What there is to tell.
    pub fn news(&self) -> impl Iterator<Item = News> + '_ {
        self.news.try_iter()
    }

    /// Waits for all errands and returns what there is left to tell.
    pub fn finish(mut self) -> Vec<News> {
        self.join();
        self.news.try_iter().collect()
    }

    fn join(&mut self) {
        self.errands = None;
        if let Some(thread) = self.thread.take() {
            // A panic was already reported on stderr.
            let _ = thread.join();
        }
    }
}

impl Drop for Errands {
    fn drop(&mut self) {
        self.join();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errands_are_done_in_order_and_all_before_the_end() {
        let (words, heard) = channel();
        let errands = Errands::start(move || words.send(()).unwrap_or(())).expect("a thread starts");
        for i in 0..5 {
            errands.run(Box::new(move || (i % 2 == 0).then(|| News::Done(i.to_string()))));
        }
        let expected: Vec<News> = ["0", "2", "4"].map(|text| News::Done(text.to_owned())).into();
        assert_eq!(errands.finish(), expected);
        assert_eq!(heard.iter().count(), 3);
    }
}
