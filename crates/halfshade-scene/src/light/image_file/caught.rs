//! Panics of a decoder that isn't ours, as answers.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
}

/// Result of `work`, or `None` if it panics, of which nothing is printed. For work on this thread that leaves nothing
/// behind.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_CAUGHT.get() {
                before(panic);
            }
        }));
    });
    let was = IS_CAUGHT.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work)).ok();
    IS_CAUGHT.set(was);
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_answer() {
        assert_eq!(caught(|| 3), Some(3));
        assert_eq!(caught(|| -> i32 { panic!("of a decoder") }), None);
        assert!(!IS_CAUGHT.get());
    }
}
