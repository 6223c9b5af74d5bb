//! Errors and warnings with their place in the file.

use std::fmt;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, Severity, SourceCode};

pub use super::problem::Problem;
use super::tree::{Place, Span};

/// A problem and the value at fault.
#[derive(Clone, Debug)]
pub(crate) struct Fault {
    pub problem: Problem,
    pub place: Place,
}

/// The file that is read.
#[derive(Debug)]
pub(crate) struct Source {
    name: String,
    text: NamedSource<String>,
}

impl Source {
    pub fn new(name: &str, text: &str) -> Arc<Self> {
        Arc::new(Self { name: name.to_owned(), text: NamedSource::new(name, text.to_owned()) })
    }

    /// Byte at which a line and column stand.
    fn offset(&self, span: Span) -> usize {
        let text = self.text.inner();
        let line = text.split_inclusive('\n').nth(span.line - 1).unwrap_or_default();
        let start = if line.is_empty() { text.len() } else { line.as_ptr() as usize - text.as_ptr() as usize };
        start + line.char_indices().nth(span.column - 1).map_or(line.len(), |(offset, _)| offset)
    }
}

#[derive(Clone, Debug)]
struct Details {
    source: Arc<Source>,
    problem: Problem,
    span: Span,
    overrides: Vec<String>,
}

impl Details {
    fn label(&self) -> Option<LabeledSpan> {
        let offset = self.source.offset(self.span);
        let length = self.span.length.min(self.source.text.inner().len().saturating_sub(offset));
        self.overrides.is_empty().then(|| LabeledSpan::new(Some("here".to_owned()), offset, length))
    }
}

impl fmt::Display for Details {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { source, problem, span, overrides } = self;
        if overrides.is_empty() {
            return write!(f, "{}:{}:{}: {problem}", source.name, span.line, span.column);
        }
        write!(f, "{}:", source.name)?;
        for text in overrides {
            write!(f, " --set {text}")?;
        }
        write!(f, ": {problem}")
    }
}

macro_rules! located {
    ($(#[$doc:meta])* $name:ident, $severity:expr) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub struct $name(Box<Details>);

        impl $name {
            /// The problem in the file, or in the overrides (as `path=value`) where these are at fault.
            pub(crate) fn new(source: &Arc<Source>, problem: Problem, span: Span, overrides: Vec<String>) -> Self {
                Self(Box::new(Details { source: Arc::clone(source), problem, span, overrides }))
            }

            /// What is wrong, as data.
            pub fn problem(&self) -> &Problem {
                &self.0.problem
            }

            /// What is wrong, without the place.
            pub fn message(&self) -> String {
                self.0.problem.to_string()
            }

            /// What to do about it.
            pub fn remedy(&self) -> String {
                self.0.problem.remedy()
            }

            /// Name of the file, as given to the reader.
            pub fn file(&self) -> &str {
                &self.0.source.name
            }

            /// Line in the file, counted from 1; `None` where an override is at fault.
            pub fn line(&self) -> Option<usize> {
                self.0.overrides.is_empty().then_some(self.0.span.line)
            }

            /// Column in the line, in characters counted from 1; `None` where an override is at fault.
            pub fn column(&self) -> Option<usize> {
                self.0.overrides.is_empty().then_some(self.0.span.column)
            }

            /// The overrides at fault, as `path=value`.
            pub fn overrides(&self) -> &[String] {
                &self.0.overrides
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }

        impl std::error::Error for $name {}

        impl Diagnostic for $name {
            fn severity(&self) -> Option<Severity> {
                Some($severity)
            }

            fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
                Some(Box::new(self.remedy()))
            }

            fn source_code(&self) -> Option<&dyn SourceCode> {
                self.0.overrides.is_empty().then_some(&self.0.source.text)
            }

            fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
                self.0.label().map(|label| Box::new(std::iter::once(label)) as Box<dyn Iterator<Item = LabeledSpan>>)
            }
        }
    };
}

located!(
    /// Why a scenario is refused.
    ///
    /// `Display` gives one line, `file:line:column: what` (or `file: --set path=value: what`); [`miette::Diagnostic`] adds
    /// the line of the file and the remedy.
    ScenarioError,
    Severity::Error
);

located!(
    /// What is allowed, but probably not meant.
    Warning,
    Severity::Warning
);

#[cfg(test)]
mod tests {
    use miette::NarratableReportHandler;

    #[test]
    fn reports_show_the_line_and_the_remedy() {
        let text = b"format: cohaul/1\nname: x\nworld: plane\n";
        let error = crate::scenario::parse("x.yaml", text, &[]).unwrap_err();
        let mut report = String::new();
        NarratableReportHandler::new().render_report(&mut report, &error).unwrap();
        for part in ["x.yaml:3:8: `world`: unknown value `plane`", "world: plane", "write one of `planar`, `spatial`"] {
            assert!(report.contains(part), "{report}");
        }
    }
}
