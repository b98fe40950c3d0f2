//! Waits for answers of the device: on a blocked thread, and in a page, whose one thread must not block, by suspending
//! the call of WebAssembly until the browser has called back (JavaScript Promise Integration).

#[cfg(not(target_arch = "wasm32"))]
mod blocked {
    use std::{
        sync::mpsc::{Receiver, RecvTimeoutError},
        time::Duration,
    };

    pub use pollster::block_on;

    /// An answer that a callback of the device sends within this time.
    ///
    /// # Errors
    /// None came, or none will.
    pub fn receive<T>(answers: &Receiver<T>, most: Duration) -> Result<T, RecvTimeoutError> {
        answers.recv_timeout(most)
    }

    /// Tells a waiting call that an answer is there, which a blocked thread hears without.
    pub fn wake() {}
}

#[cfg(target_arch = "wasm32")]
mod suspended {
    use std::{
        pin::pin,
        sync::{
            Arc,
            mpsc::{Receiver, TryRecvError},
        },
        task::{Context, Poll, Wake},
        time::Duration,
    };

    #[expect(
        unsafe_code,
        reason = "a suspending import is called without JavaScript of the binding's between, which cannot be suspended"
    )]
    mod page {
        #[link(wasm_import_module = "./suspend.js")]
        unsafe extern "C" {
            /// Returns after the next call of [`wake`], or at once if there was one since the last return.
            pub safe fn suspend();
            pub safe fn wake();
        }
    }

    pub use page::wake;

    struct Waker;

    impl Wake for Waker {
        fn wake(self: Arc<Self>) {
            wake();
        }
    }

    /// The result of a future.
    pub fn block_on<T>(future: impl Future<Output = T>) -> T {
        let mut future = pin!(future);
        let waker = Arc::new(Waker).into();
        loop {
            match future.as_mut().poll(&mut Context::from_waker(&waker)) {
                Poll::Ready(result) => return result,
                Poll::Pending => page::suspend(),
            }
        }
    }

    /// An answer that a callback of the device sends; browsers answer for lost devices too, so no time is measured.
    ///
    /// # Errors
    /// None will come.
    pub fn receive<T>(answers: &Receiver<T>, _: Duration) -> Result<T, TryRecvError> {
        loop {
            match answers.try_recv() {
                Err(TryRecvError::Empty) => page::suspend(),
                other => return other,
            }
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
pub use blocked::{block_on, receive, wake};
#[cfg(target_arch = "wasm32")]
pub use suspended::{block_on, receive, wake};
