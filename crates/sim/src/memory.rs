//! The edge: how much memory the process holds. Results never depend on it, but for searches that run out of it.
#![expect(clippy::disallowed_methods, reason = "the system tells it in a file")]

/// Bytes of a page, as Linux counts on all platforms that are built for.
const PAGE: f64 = 4096.0;

/// Bytes of memory that the process holds; 0 where the system does not say.
pub fn resident() -> f64 {
    // size and resident size in pages
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<f64>().ok()).unwrap_or(0.0) * PAGE
}
