//! YAML as a flat tree that remembers where everything stands.
//!
//! Instance files are regular: [`plain`] reads the part of YAML that they use in one pass, without a copy of the text. What it
//! does not know for certain goes to the YAML library ([`library`]), with limits against nesting and aliases; both make the
//! same tree.

mod library;
mod plain;

use super::error::{FormatError, FormatProblem, abbreviated};

/// Longest file, bytes.
pub(crate) const MAX_BYTES: usize = 64 << 20;
/// Most values in a file: 256 MiB of tree, twice that while it grows.
const MAX_NODES: usize = 16 << 20;
/// How deep values may be nested.
const MAX_DEPTH: usize = 32;

/// All values of a file in the order in which they stand, a map's keys before their values.
pub(crate) struct Tree<'t> {
    name: &'t str,
    text: &'t str,
    /// Scalars that do not stand in the text as they are meant; empty where all do.
    copied: String,
    nodes: Vec<Raw>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Null,
    Plain,
    Quoted,
    List,
    Map,
}

#[derive(Clone, Copy, Debug)]
struct Raw {
    kind: Kind,
    /// Where it stands in the text, bytes.
    place: u32,
    /// Scalars: first byte; lists and maps: how many entries.
    from: u32,
    /// Scalars: the byte after the last; lists and maps: the node after the last of theirs.
    to: u32,
}

/// A value in a tree.
#[derive(Clone, Copy)]
pub(crate) struct Node<'a> {
    tree: &'a Tree<'a>,
    index: usize,
}

impl<'t> Tree<'t> {
    /// Reads `text`; `name` is the file's, for messages.
    pub fn read(name: &'t str, text: &'t str) -> Result<Self, FormatError> {
        if text.len() > MAX_BYTES {
            let problem = FormatProblem::TooMany { what: "bytes of the file", count: text.len(), most: MAX_BYTES };
            return Err(FormatError::new(name, 1, 1, problem));
        }
        match plain::read(text) {
            Ok(nodes) => Ok(Self { name, text, copied: String::new(), nodes }),
            Err(plain::Refused::TooMany) => {
                let problem =
                    FormatProblem::TooMany { what: "values in the file", count: MAX_NODES + 1, most: MAX_NODES };
                Err(FormatError::new(name, 1, 1, problem))
            }
            Err(plain::Refused::Beyond) => {
                let (nodes, copied) = library::read(name, text)?;
                Ok(Self { name, text, copied, nodes })
            }
        }
    }

    pub fn root(&self) -> Node<'_> {
        Node { tree: self, index: 0 }
    }
}

impl<'a> Node<'a> {
    fn raw(self) -> Raw {
        self.tree.nodes.get(self.index).copied().unwrap_or(Raw { kind: Kind::Null, place: 0, from: 0, to: 0 })
    }

    fn scalar(self) -> &'a str {
        let Raw { from, to, .. } = self.raw();
        let tree = self.tree;
        let text = if tree.copied.is_empty() { tree.text } else { &tree.copied };
        text.get(from as usize..to as usize).unwrap_or_default()
    }

    fn after(self) -> usize {
        let raw = self.raw();
        match raw.kind {
            Kind::List | Kind::Map => raw.to as usize,
            _ => self.index + 1,
        }
    }

    fn children(self) -> impl Iterator<Item = Self> {
        let end = self.after();
        let mut next = self.index + 1;
        std::iter::from_fn(move || {
            let child = Self { tree: self.tree, index: next };
            (next < end).then(|| {
                next = child.after();
                child
            })
        })
    }

    /// An error about this value.
    pub fn error(self, problem: FormatProblem) -> FormatError {
        FormatError::at(self.tree.name, self.tree.text, self.raw().place as usize, problem)
    }

    /// An error about its type.
    pub fn wrong(self, what: &str, expected: &str) -> FormatError {
        let found = match self.raw().kind {
            Kind::Null => "nothing".to_owned(),
            Kind::Plain => format!("`{}`", abbreviated(self.scalar())),
            Kind::Quoted => format!("the text \"{}\"", abbreviated(self.scalar())),
            Kind::List => format!("a list of {}", self.raw().from),
            Kind::Map => format!("a map with {} keys", self.raw().from),
        };
        self.error(FormatProblem::WrongType { what: what.to_owned(), expected: expected.to_owned(), found })
    }

    pub fn is_null(self) -> bool {
        self.raw().kind == Kind::Null
    }

    /// How many entries a list or map has.
    pub fn len(self) -> usize {
        match self.raw().kind {
            Kind::List | Kind::Map => self.raw().from as usize,
            _ => 0,
        }
    }

    /// A map's keys, as nodes, with their values.
    pub fn entries(self, what: &str) -> Result<impl Iterator<Item = (Self, &'a str, Self)>, FormatError> {
        if self.raw().kind != Kind::Map {
            return Err(self.wrong(what, "a map"));
        }
        let mut children = self.children();
        Ok(std::iter::from_fn(move || Some((children.next()?, children.next()?)))
            .map(|(key, value)| (key, key.scalar(), value)))
    }

    /// The values of a map's keys; `place` names the map in messages. Other keys, or one twice, are errors.
    pub fn fields<const N: usize>(
        self,
        place: &'static str,
        known: [&'static str; N],
    ) -> Result<[Option<Self>; N], FormatError> {
        let mut found = [None; N];
        for (key, name, value) in self.entries(place)? {
            match known.iter().position(|known| *known == name) {
                Some(index) if found[index].is_some() => {
                    return Err(key.error(FormatProblem::DuplicateKey { key: name.to_owned() }));
                }
                Some(index) => found[index] = Some(value),
                None => {
                    let problem = FormatProblem::UnknownKey { key: abbreviated(name), place, allowed: known.to_vec() };
                    return Err(key.error(problem));
                }
            }
        }
        Ok(found)
    }

    /// The value of `key` in a map, if it is one and has it.
    pub fn get(self, key: &str) -> Option<Self> {
        let mut entries = self.entries("").ok()?;
        entries.find(|(_, name, _)| *name == key).map(|(_, _, value)| value)
    }

    /// A list's entries; none where nothing is given.
    pub fn items(self, what: &str) -> Result<impl Iterator<Item = Self>, FormatError> {
        match self.raw().kind {
            Kind::List | Kind::Null => Ok(self.children()),
            _ => Err(self.wrong(what, "a list")),
        }
    }

    /// A finite number.
    pub fn number(self, what: &str) -> Result<f64, FormatError> {
        let text = self.scalar();
        let digits = text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
        match text.parse::<f64>() {
            Ok(value) if self.raw().kind == Kind::Plain && digits && value.is_finite() => Ok(value + 0.0), // no −0
            _ => Err(self.wrong(what, "a finite number")),
        }
    }

    /// A whole number.
    pub fn whole(self, what: &str) -> Result<i64, FormatError> {
        if self.raw().kind == Kind::Plain
            && let Ok(value) = self.scalar().parse::<i64>()
        {
            return Ok(value);
        }
        match self.number(what) {
            // 2⁵³: beyond it a float no longer names one whole number
            Ok(value) if value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0 => Ok(value as i64),
            _ => Err(self.wrong(what, "a whole number")),
        }
    }

    /// A text; numbers count as texts.
    pub fn text(self, what: &str) -> Result<&'a str, FormatError> {
        match self.raw().kind {
            Kind::Plain | Kind::Quoted => Ok(self.scalar()),
            _ => Err(self.wrong(what, "a text")),
        }
    }

    /// The entries of a list of exactly N.
    pub fn tuple<const N: usize>(self, what: &str, expected: &str) -> Result<[Self; N], FormatError> {
        if self.raw().kind != Kind::List || self.len() != N {
            return Err(self.wrong(what, expected));
        }
        let mut found = [self; N];
        for (slot, child) in found.iter_mut().zip(self.children()) {
            *slot = child;
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests;
