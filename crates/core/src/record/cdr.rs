//! Common Data Representation, little-endian: the wire format of ROS 2 messages.
//!
//! # Source
//! [CDR] §9.3 (plain CDR, version 1), behind the four-byte encapsulation header `00 01 00 00`. Alignment counts from the
//! byte after that header; primitives align to their size, at most 8.
//!
//! [CDR]: crate::_documentation::references

/// Encapsulation header: plain CDR, little-endian, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Why bytes are not the message they claim to be. Offsets count from the first byte of the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CdrError {
    /// The payload does not start with `00 01`: not little-endian plain CDR.
    #[error("payload starts with {first:02x} {second:02x} instead of 00 01")]
    Encapsulation {
        /// First byte.
        first: u8,
        /// Second byte.
        second: u8,
    },
    /// The payload ends inside a value.
    #[error("payload of {len} bytes ends inside a value of {needed} bytes at byte {at}")]
    Truncated {
        /// Length of the payload, bytes.
        len: usize,
        /// Where the value should stand, bytes.
        at: usize,
        /// Its length, bytes.
        needed: usize,
    },
    /// A string is not UTF-8 or lacks its final NUL.
    #[error("string at byte {at} is not text")]
    Text {
        /// Where the characters start, bytes.
        at: usize,
    },
    /// A number has no meaning in its field.
    #[error("{field} at byte {at} is {value}, which stands for nothing")]
    Value {
        /// The field.
        field: &'static str,
        /// Where it stands, bytes.
        at: usize,
        /// The number.
        value: u64,
    },
    /// Bytes are left over after the last field.
    #[error("{extra} bytes follow the last field at byte {at}")]
    Trailing {
        /// How many.
        extra: usize,
        /// Where they start, bytes.
        at: usize,
    },
}

/// Appends one message to a buffer that its caller reuses.
#[derive(Debug)]
pub struct Encoder<'a> {
    out: &'a mut Vec<u8>,
    start: usize,
}

macro_rules! put {
    ($($(#[$doc:meta])* $name:ident: $type:ty),*) => {$(
        $(#[$doc])*
        pub fn $name(&mut self, value: $type) {
            self.align(size_of::<$type>());
            self.out.extend_from_slice(&value.to_le_bytes());
        }
    )*};
}

impl<'a> Encoder<'a> {
    /// Writes the encapsulation header; the fields follow.
    pub fn new(out: &'a mut Vec<u8>) -> Self {
        out.extend_from_slice(&ENCAPSULATION);
        let start = out.len();
        Self { out, start }
    }

    fn align(&mut self, size: usize) {
        let used = self.out.len() - self.start;
        self.out.resize(self.start + used.next_multiple_of(size), 0);
    }

    put! {
        /// An unsigned byte.
        u8: u8,
        /// A 16-bit unsigned integer.
        u16: u16,
        /// A 32-bit unsigned integer.
        u32: u32,
        /// A 32-bit signed integer.
        i32: i32,
        /// A 64-bit unsigned integer.
        u64: u64,
        /// A 64-bit signed integer.
        i64: i64,
        /// A float, bit for bit.
        f32: f32,
        /// A double, bit for bit.
        f64: f64
    }

    /// A boolean: 0 or 1.
    pub fn bool(&mut self, value: bool) {
        self.u8(u8::from(value));
    }

    /// A string, with its length and final NUL. Lengths beyond 32 bits do not occur in a log.
    pub fn string(&mut self, value: &str) {
        self.u32(value.len() as u32 + 1);
        self.out.extend_from_slice(value.as_bytes());
        self.out.push(0);
    }

    /// Number of elements of a sequence; the elements follow.
    pub fn sequence(&mut self, len: usize) {
        self.u32(len as u32);
    }

    /// A sequence of bytes with its length.
    pub fn bytes(&mut self, value: &[u8]) {
        self.sequence(value.len());
        self.out.extend_from_slice(value);
    }
}

/// Takes the fields out of one payload. Never panics, never allocates.
#[derive(Clone, Debug)]
pub struct Decoder<'a> {
    payload: &'a [u8],
    at: usize,
}

macro_rules! take {
    ($($(#[$doc:meta])* $name:ident: $type:ty),*) => {$(
        $(#[$doc])*
        ///
        /// # Errors
        /// If the payload ends first.
        pub fn $name(&mut self) -> Result<$type, CdrError> {
            self.align(size_of::<$type>());
            let truncated = self.truncated(size_of::<$type>());
            let (bytes, _) = self.rest().split_first_chunk().ok_or(truncated)?;
            self.at += bytes.len();
            Ok(<$type>::from_le_bytes(*bytes))
        }
    )*};
}

impl<'a> Decoder<'a> {
    /// Checks the encapsulation header.
    ///
    /// # Errors
    /// If the payload is not little-endian plain CDR.
    pub fn new(payload: &'a [u8]) -> Result<Self, CdrError> {
        match payload {
            [0, 1, _, _, ..] => Ok(Self { payload, at: ENCAPSULATION.len() }),
            [first, second, _, _, ..] => Err(CdrError::Encapsulation { first: *first, second: *second }),
            _ => Err(CdrError::Truncated { len: payload.len(), at: 0, needed: ENCAPSULATION.len() }),
        }
    }

    fn rest(&self) -> &'a [u8] {
        self.payload.get(self.at..).unwrap_or_default()
    }

    fn truncated(&self, needed: usize) -> CdrError {
        CdrError::Truncated { len: self.payload.len(), at: self.at, needed }
    }

    fn align(&mut self, size: usize) {
        let used = self.at - ENCAPSULATION.len();
        self.at = used.next_multiple_of(size) + ENCAPSULATION.len();
    }

    /// Where the next field is looked for, bytes from the start of the payload.
    pub const fn at(&self) -> usize {
        self.at
    }

    take! {
        /// An unsigned byte.
        u8: u8,
        /// A 16-bit unsigned integer.
        u16: u16,
        /// A 32-bit unsigned integer.
        u32: u32,
        /// A 32-bit signed integer.
        i32: i32,
        /// A 64-bit unsigned integer.
        u64: u64,
        /// A 64-bit signed integer.
        i64: i64,
        /// A float, bit for bit.
        f32: f32,
        /// A double, bit for bit; NaN and infinities pass.
        f64: f64
    }

    /// A boolean.
    ///
    /// # Errors
    /// If it is neither 0 nor 1.
    pub fn bool(&mut self, field: &'static str) -> Result<bool, CdrError> {
        let at = self.at;
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            value => Err(CdrError::Value { field, at, value: u64::from(value) }),
        }
    }

    /// A string.
    ///
    /// # Errors
    /// If it is cut off, not UTF-8, or lacks its final NUL.
    pub fn string(&mut self) -> Result<&'a str, CdrError> {
        let len = self.u32()? as usize;
        let at = self.at;
        let bytes = self.take(len)?;
        match bytes.split_last() {
            Some((0, text)) => std::str::from_utf8(text).map_err(|_| CdrError::Text { at }),
            _ => Err(CdrError::Text { at }),
        }
    }

    /// Number of elements of a sequence whose elements take at least `element` bytes each.
    ///
    /// # Errors
    /// If so many cannot follow: memory reserved for the result stays within a small multiple of the payload.
    pub fn sequence(&mut self, element: usize) -> Result<usize, CdrError> {
        let len = self.u32()? as usize;
        let needed = len.saturating_mul(element);
        if needed > self.rest().len() { Err(self.truncated(needed)) } else { Ok(len) }
    }

    /// A sequence of bytes.
    ///
    /// # Errors
    /// If it is cut off.
    pub fn bytes(&mut self) -> Result<&'a [u8], CdrError> {
        let len = self.u32()? as usize;
        self.take(len)
    }

    fn take(&mut self, len: usize) -> Result<&'a [u8], CdrError> {
        let taken = self.rest().get(..len).ok_or(self.truncated(len))?;
        self.at += len;
        Ok(taken)
    }

    /// Checks that the message ends here, but for up to three bytes of padding.
    ///
    /// # Errors
    /// If more bytes follow.
    pub fn finish(self) -> Result<(), CdrError> {
        let extra = self.rest().len();
        if extra > 3 { Err(CdrError::Trailing { extra, at: self.at }) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primitives_align_to_their_size_behind_the_header() {
        let mut out = Vec::new();
        let mut encoder = Encoder::new(&mut out);
        encoder.u8(1);
        encoder.f64(2.0);
        encoder.u16(3);
        encoder.string("ab");
        assert_eq!(
            out,
            [
                &[0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0][..],
                &2.0_f64.to_le_bytes(),
                &[3, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0]
            ]
            .concat()
        );
        let mut decoder = Decoder::new(&out).unwrap();
        assert_eq!(decoder.u8(), Ok(1));
        assert_eq!(decoder.f64(), Ok(2.0));
        assert_eq!(decoder.u16(), Ok(3));
        assert_eq!(decoder.string(), Ok("ab"));
        assert_eq!(decoder.finish(), Ok(()));
    }

    #[test]
    fn a_length_beyond_the_payload_is_an_error() {
        let payload = [0, 1, 0, 0, 255, 255, 255, 255];
        assert!(matches!(Decoder::new(&payload).unwrap().string(), Err(CdrError::Truncated { .. })));
        assert!(matches!(Decoder::new(&payload).unwrap().sequence(8), Err(CdrError::Truncated { .. })));
        assert!(matches!(Decoder::new(&payload).unwrap().bytes(), Err(CdrError::Truncated { .. })));
    }
}
