//! Guides and sources, kept as Markdown beside the code.

#[doc = include_str!("references.md")]
pub mod references {}
