//! Meshes known by identity, not by content.

use std::sync::{Arc, Weak};

/// Equal for an original and its copies only.
#[derive(Clone, Debug, Default)]
pub(crate) struct Identity(Arc<()>);

impl Identity {
    /// Something to know it by that does not keep it.
    pub(crate) fn mark(&self) -> Mark {
        Mark(Arc::downgrade(&self.0))
    }
}

/// Reminder of an [`Identity`].
#[derive(Debug)]
pub(crate) struct Mark(Weak<()>);

impl Mark {
    pub(crate) fn is_of(&self, identity: &Identity) -> bool {
        // A weak reference keeps its address from being given to another mesh, so that equal
        // addresses are enough.
        std::ptr::eq(self.0.as_ptr(), Arc::as_ptr(&identity.0))
    }

    /// Whether nothing of that identity is left.
    pub(crate) fn is_stale(&self) -> bool {
        self.0.strong_count() == 0
    }
}
