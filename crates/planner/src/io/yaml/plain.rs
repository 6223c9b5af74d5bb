//! The part of YAML that instance files and plans are written in: maps and lists by indentation, lists and maps in brackets,
//! scalars on one line, comments. ASCII only. Whatever looks different is refused, never guessed.

use super::{Kind, MAX_DEPTH, MAX_NODES, Raw};

/// Why a text was not read here.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Refused {
    /// It is not of the part of YAML that is read here; it may be YAML all the same.
    Beyond,
    /// It has more values than are read.
    TooMany,
}

use Refused::{Beyond, TooMany};

type Done = Result<(), Refused>;

pub(super) fn read(text: &str) -> Result<Vec<Raw>, Refused> {
    // a value takes about 8 bytes
    let nodes = Vec::with_capacity((text.len() / 8).min(MAX_NODES) + 8);
    let mut reader = Reader { text: text.as_bytes(), at: 0, line: 0, nodes, depth: 0 };
    reader.gap()?;
    if reader.text[reader.at..].starts_with(b"---") {
        return Err(Beyond);
    }
    if reader.peek().is_none() {
        reader.push(Kind::Null, 0, 0, 0)?;
    } else {
        reader.block(-1)?;
        reader.gap()?;
        if reader.peek().is_some() {
            return Err(Beyond);
        }
    }
    Ok(reader.nodes)
}

struct Reader<'t> {
    text: &'t [u8],
    at: usize,
    /// Where the line began.
    line: usize,
    nodes: Vec<Raw>,
    depth: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Whether the byte at `at` is white, or past the end.
    fn is_white(&self, at: usize) -> bool {
        matches!(self.text.get(at), None | Some(b' ' | b'\n' | b'\r'))
    }

    fn column(&self) -> i64 {
        (self.at - self.line) as i64
    }

    fn push(&mut self, kind: Kind, place: usize, from: usize, to: usize) -> Done {
        if self.nodes.len() >= MAX_NODES {
            return Err(TooMany);
        }
        // texts are no longer than MAX_BYTES
        self.nodes.push(Raw { kind, place: place as u32, from: from as u32, to: to as u32 });
        Ok(())
    }

    fn open(&mut self, kind: Kind) -> Result<usize, Refused> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(Beyond);
        }
        let index = self.nodes.len();
        self.push(kind, self.at, 0, 0)?;
        Ok(index)
    }

    fn close(&mut self, index: usize, entries: usize) {
        self.depth -= 1;
        let end = self.nodes.len() as u32;
        let node = &mut self.nodes[index];
        node.from = entries as u32;
        node.to = end;
    }

    fn spaces(&mut self) {
        while self.peek() == Some(b' ') {
            self.at += 1;
        }
    }

    /// Passes the end of the line if nothing but a comment is left on it.
    fn end_of_line(&mut self) -> Result<bool, Refused> {
        self.spaces();
        if self.peek() == Some(b'#') && (self.at == self.line || self.text[self.at - 1] == b' ') {
            while let Some(byte) = self.peek() {
                if byte == b'\n' {
                    break;
                }
                // a comment may hold anything but what may be a line break elsewhere
                let is_return = byte == b'\r' && self.text.get(self.at + 1) == Some(&b'\n');
                if !(is_return || (b' '..=b'~').contains(&byte)) {
                    return Err(Beyond);
                }
                self.at += 1;
            }
        }
        match self.peek() {
            None => Ok(true),
            Some(b'\n') => {
                self.at += 1;
                self.line = self.at;
                Ok(true)
            }
            Some(b'\r') if self.text.get(self.at + 1) == Some(&b'\n') => {
                self.at += 2;
                self.line = self.at;
                Ok(true)
            }
            Some(_) => Ok(false),
        }
    }

    /// Passes white space, line breaks and comments.
    fn gap(&mut self) -> Done {
        while self.end_of_line()? && self.peek().is_some() {}
        Ok(())
    }

    fn is_entry(&self) -> bool {
        self.peek() == Some(b'-') && self.is_white(self.at + 1)
    }

    /// The value that begins here; `outer` is the indentation of what holds it.
    fn block(&mut self, outer: i64) -> Done {
        if self.is_entry() {
            return self.block_list();
        }
        match self.key()? {
            Some(_) => self.block_map(),
            None => self.inline(outer),
        }
    }

    fn block_list(&mut self) -> Done {
        let column = self.column();
        let list = self.open(Kind::List)?;
        let mut entries = 0;
        loop {
            entries += 1;
            self.at += 1;
            let place = self.at - 1;
            if self.end_of_line()? {
                self.gap()?;
                if self.peek().is_some() && self.column() > column {
                    self.block(column)?;
                } else {
                    self.push(Kind::Null, place, 0, 0)?;
                }
            } else {
                self.block(column)?;
            }
            self.gap()?;
            if self.peek().is_none() || self.column() < column || (self.column() == column && !self.is_entry()) {
                break;
            }
            if self.column() > column {
                return Err(Beyond);
            }
        }
        self.close(list, entries);
        Ok(())
    }

    fn block_map(&mut self) -> Done {
        let column = self.column();
        let map = self.open(Kind::Map)?;
        let mut entries = 0;
        while let Some((from, to)) = self.key()? {
            entries += 1;
            self.push(Kind::Plain, from, from, to)?;
            self.at = to + 1;
            if self.end_of_line()? {
                self.gap()?;
                let deeper = self.peek().is_some() && self.column() > column;
                if deeper || (self.peek().is_some() && self.column() == column && self.is_entry()) {
                    self.block(column)?;
                } else {
                    self.push(Kind::Null, from, 0, 0)?;
                }
            } else if self.is_entry() || self.key()?.is_some() {
                return Err(Beyond);
            } else {
                self.inline(column)?;
            }
            self.gap()?;
            if self.peek().is_none() || self.column() < column {
                self.close(map, entries);
                return Ok(());
            }
            if self.column() > column {
                return Err(Beyond);
            }
        }
        Err(Beyond)
    }

    /// A key that begins here and its colon: where the key begins, where the colon stands.
    fn key(&self) -> Result<Option<(usize, usize)>, Refused> {
        let mut end = self.at;
        while self.text.get(end).is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_') {
            end += 1;
        }
        let is_key = end > self.at && self.text.get(end) == Some(&b':') && self.is_white(end + 1);
        Ok(is_key.then_some((self.at, end)))
    }

    /// A value that ends on its line, but for brackets.
    fn inline(&mut self, outer: i64) -> Done {
        match self.peek() {
            Some(b'[') => self.flow_list(outer)?,
            Some(b'{') => self.flow_map(outer)?,
            Some(b'"' | b'\'') => self.quoted()?,
            _ => self.plain()?,
        }
        if !self.end_of_line()? {
            return Err(Beyond);
        }
        self.gap()?;
        // deeper lines would go on with the scalar
        if self.peek().is_some() && self.column() > outer { Err(Beyond) } else { Ok(()) }
    }

    fn scalar(&mut self, from: usize, to: usize) -> Done {
        let kind = match &self.text[from..to] {
            b"~" | b"null" | b"Null" | b"NULL" => Kind::Null,
            _ => Kind::Plain,
        };
        self.push(kind, from, from, to)
    }

    fn plain(&mut self) -> Done {
        let from = self.at;
        let mut to = from;
        while let Some(byte) = self.peek() {
            match byte {
                b'\n' => break,
                b'\r' if self.text.get(self.at + 1) == Some(&b'\n') => break,
                b' ' if self.text.get(self.at + 1) == Some(&b'#') => break,
                b' ' => {}
                b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'_' | b'/' | b'.' | b'+' => to = self.at + 1,
                b'~' if self.at == from && self.is_white(self.at + 1) => to = self.at + 1,
                // a dash and a space would be a list
                b'-' if !self.is_white(self.at + 1) || self.at > from => to = self.at + 1,
                _ => return Err(Beyond),
            }
            self.at += 1;
        }
        if to == from || self.text[from..to].starts_with(b"---") || self.text[from..to].starts_with(b"...") {
            return Err(Beyond);
        }
        self.scalar(from, to)
    }

    fn quoted(&mut self) -> Done {
        let place = self.at;
        let quote = self.text[place];
        let mut at = place + 1;
        while let Some(byte) = self.text.get(at) {
            if *byte == quote {
                // a second quote would be a quote in the text
                if self.text.get(at + 1) == Some(&quote) {
                    return Err(Beyond);
                }
                self.at = at + 1;
                return self.push(Kind::Quoted, place, place + 1, at);
            }
            if *byte == b'\\' || !(b' '..=b'~').contains(byte) {
                return Err(Beyond);
            }
            at += 1;
        }
        Err(Beyond)
    }

    /// White space between brackets; a line must be indented more than what holds the brackets.
    fn flow_gap(&mut self, outer: i64) -> Done {
        let line = self.line;
        self.gap()?;
        if self.peek().is_none() || (self.line != line && self.column() <= outer) { Err(Beyond) } else { Ok(()) }
    }

    fn flow_scalar(&mut self) -> Done {
        let from = self.at;
        while let Some(byte) = self.peek() {
            match byte {
                b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'_' | b'.' | b'+' => {}
                b'-' if self.text.get(self.at + 1).is_some_and(u8::is_ascii_alphanumeric)
                    || self.text.get(self.at + 1) == Some(&b'.') => {}
                _ => break,
            }
            self.at += 1;
        }
        if self.at == from { Err(Beyond) } else { self.scalar(from, self.at) }
    }

    fn flow(&mut self, outer: i64) -> Done {
        match self.peek() {
            Some(b'[') => self.flow_list(outer),
            Some(b'{') => self.flow_map(outer),
            Some(b'"' | b'\'') => self.quoted(),
            _ => self.flow_scalar(),
        }
    }

    fn flow_list(&mut self, outer: i64) -> Done {
        let list = self.open(Kind::List)?;
        let mut entries = 0;
        self.at += 1;
        loop {
            self.flow_gap(outer)?;
            if self.peek() == Some(b']') {
                break;
            }
            self.flow(outer)?;
            entries += 1;
            self.flow_gap(outer)?;
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b']') => break,
                _ => return Err(Beyond),
            }
        }
        self.at += 1;
        self.close(list, entries);
        Ok(())
    }

    fn flow_map(&mut self, outer: i64) -> Done {
        let map = self.open(Kind::Map)?;
        let mut entries = 0;
        self.at += 1;
        loop {
            self.flow_gap(outer)?;
            if self.peek() == Some(b'}') {
                break;
            }
            let Some((from, to)) = self.key()? else { return Err(Beyond) };
            self.push(Kind::Plain, from, from, to)?;
            self.at = to + 1;
            entries += 1;
            self.flow_gap(outer)?;
            if matches!(self.peek(), Some(b',' | b'}')) {
                self.push(Kind::Null, from, 0, 0)?;
            } else {
                self.flow(outer)?;
                self.flow_gap(outer)?;
            }
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b'}') => break,
                _ => return Err(Beyond),
            }
        }
        self.at += 1;
        self.close(map, entries);
        Ok(())
    }
}
