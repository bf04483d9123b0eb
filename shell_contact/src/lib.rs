//! A coated microbubble between two plates.
