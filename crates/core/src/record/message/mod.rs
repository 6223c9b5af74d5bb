//! Every message of a log: its fields, its CDR and its `.msg` text.
//!
//! Standard ROS 2 types stand in [`standard`], those of the package `cohaul_msgs` in [`cohaul`]. The texts of the latter
//! are the files of the ament package in `crates/core/msg/`: one source for the code, the log and ROS 2.

pub mod cohaul;
pub mod standard;

use super::cdr::{CdrError, Decoder, Encoder};

/// One `.msg` definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Definition {
    /// `package/Type`.
    pub name: &'static str,
    /// Content of its `.msg` file.
    pub text: &'static str,
}

/// A message type with everything needed to read it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schema {
    /// `package/msg/Type`.
    pub name: &'static str,
    /// Content of its `.msg` file.
    pub text: &'static str,
    /// The types it refers to, directly and indirectly, in the order of their first mention.
    pub dependencies: &'static [Definition],
}

impl Schema {
    /// The text that `ros2msg` schemas carry: its own definition, then each dependency behind a line of 80 `=`.
    ///
    /// ```
    /// # use cohaul_core::record::message::{Message, standard::TwistStamped};
    /// let text = TwistStamped::SCHEMA.concatenated();
    /// assert!(text.starts_with("std_msgs/Header header\n"));
    /// assert!(text.contains(&format!("\n{}\nMSG: geometry_msgs/Twist\n", "=".repeat(80))));
    /// ```
    pub fn concatenated(&self) -> String {
        let mut text = self.text.to_owned();
        for dependency in self.dependencies {
            text.push_str(&"=".repeat(80));
            text.push_str("\nMSG: ");
            text.push_str(dependency.name);
            text.push('\n');
            text.push_str(dependency.text);
        }
        text
    }
}

/// A message: strings and bytes are borrowed from the payload they were decoded from.
pub trait Message<'a>: Sized {
    /// Its type.
    const SCHEMA: Schema;

    /// Appends the fields.
    fn encode(&self, out: &mut Encoder<'_>);

    /// Takes the fields out of a payload.
    ///
    /// # Errors
    /// If the payload is cut off or a field has no meaning. Numbers may be NaN or infinite: a log keeps what happened.
    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError>;

    /// Appends the payload: encapsulation header and fields.
    fn to_cdr(&self, out: &mut Vec<u8>) {
        self.encode(&mut Encoder::new(out));
    }

    /// Reads a whole payload.
    ///
    /// # Errors
    /// As [`Message::decode`], and if bytes are left over.
    fn from_cdr(payload: &'a [u8]) -> Result<Self, CdrError> {
        let mut input = Decoder::new(payload)?;
        let message = Self::decode(&mut input)?;
        input.finish()?;
        Ok(message)
    }
}
