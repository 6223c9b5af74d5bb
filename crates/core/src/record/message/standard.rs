//! Standard ROS 2 messages, as of Jazzy, so that any ROS 2 tool shows a log.

use super::{Definition, Message, Schema};
use crate::record::cdr::{CdrError, Decoder, Encoder};
use crate::se2::Pose2;
use crate::time::Time;

const TIME: Definition = Definition { name: "builtin_interfaces/Time", text: "int32 sec\nuint32 nanosec\n" };
const DURATION: Definition = Definition { name: "builtin_interfaces/Duration", text: TIME.text };
const HEADER: Definition =
    Definition { name: "std_msgs/Header", text: "builtin_interfaces/Time stamp\nstring frame_id\n" };
const COLOR: Definition =
    Definition { name: "std_msgs/ColorRGBA", text: "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n" };
const VECTOR3: Definition = Definition { name: "geometry_msgs/Vector3", text: "float64 x\nfloat64 y\nfloat64 z\n" };
const POINT: Definition = Definition { name: "geometry_msgs/Point", text: VECTOR3.text };
const QUATERNION: Definition =
    Definition { name: "geometry_msgs/Quaternion", text: "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" };
const POSE: Definition = Definition {
    name: "geometry_msgs/Pose",
    text: "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
};
const TWIST: Definition =
    Definition { name: "geometry_msgs/Twist", text: "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n" };
const TRANSFORM: Definition = Definition {
    name: "geometry_msgs/Transform",
    text: "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
};
const TRANSFORM_STAMPED: Definition = Definition {
    name: "geometry_msgs/TransformStamped",
    text: "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
};
const COMPRESSED_IMAGE: Definition =
    Definition { name: "sensor_msgs/CompressedImage", text: "std_msgs/Header header\nstring format\nuint8[] data\n" };
const UV_COORDINATE: Definition =
    Definition { name: "visualization_msgs/UVCoordinate", text: "float32 u\nfloat32 v\n" };
const MESH_FILE: Definition =
    Definition { name: "visualization_msgs/MeshFile", text: "string filename\nuint8[] data\n" };
const MARKER: Definition = Definition {
    name: "visualization_msgs/Marker",
    text: "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 LINE_LIST=5\n\
           int32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\nint32 TEXT_VIEW_FACING=9\nint32 MESH_RESOURCE=10\n\
           int32 TRIANGLE_LIST=11\nint32 ARROW_STRIP=12\nint32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\n\
           int32 DELETEALL=3\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n\
           geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n\
           builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n\
           std_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\n\
           visualization_msgs/UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n\
           visualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n",
};

/// builtin_interfaces/Time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamp {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds beyond them.
    pub nanosec: u32,
}

impl From<Time> for Stamp {
    /// Instants beyond ±68 years saturate.
    fn from(time: Time) -> Self {
        const NANOS: i64 = 1_000_000_000;
        let sec = time.nanos().div_euclid(NANOS).clamp(i64::from(i32::MIN), i64::from(i32::MAX));
        Self { sec: sec as i32, nanosec: time.nanos().rem_euclid(NANOS) as u32 }
    }
}

impl Message<'_> for Stamp {
    const SCHEMA: Schema = Schema { name: "builtin_interfaces/msg/Time", text: TIME.text, dependencies: &[] };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.i32(self.sec);
        out.u32(self.nanosec);
    }

    fn decode(input: &mut Decoder<'_>) -> Result<Self, CdrError> {
        Ok(Self { sec: input.i32()?, nanosec: input.u32()? })
    }
}

/// std_msgs/Header.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Header<'a> {
    /// When.
    pub stamp: Stamp,
    /// In which frame the message is expressed.
    pub frame_id: &'a str,
}

impl<'a> Message<'a> for Header<'a> {
    const SCHEMA: Schema = Schema { name: "std_msgs/msg/Header", text: HEADER.text, dependencies: &[TIME] };

    fn encode(&self, out: &mut Encoder<'_>) {
        self.stamp.encode(out);
        out.string(self.frame_id);
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        Ok(Self { stamp: Stamp::decode(input)?, frame_id: input.string()? })
    }
}

/// x, y, z: geometry_msgs/Point, m, or geometry_msgs/Vector3.
pub type Xyz = [f64; 3];

/// geometry_msgs/Quaternion: x, y, z, w.
pub type Quaternion = [f64; 4];

/// Rotation about the vertical axis as a quaternion.
///
/// By square roots, which every machine rounds alike. The half angle comes from the larger of its sine and cosine, so
/// that no digits cancel.
///
/// ```
/// # use cohaul_core::{record::message::standard::quaternion, se2::pose};
/// let [x, y, z, w] = quaternion(&pose(0.0, 0.0, 1.0));
/// assert_eq!((x, y), (0.0, 0.0));
/// assert!((z - 0.5_f64.sin()).abs() < 1e-15 && (w - 0.5_f64.cos()).abs() < 1e-15);
/// ```
pub fn quaternion(pose: &Pose2) -> Quaternion {
    let (cos, sin) = (pose.rotation.re, pose.rotation.im);
    if cos < 0.0 {
        let z = (0.5 * (1.0 - cos)).sqrt().copysign(sin);
        [0.0, 0.0, z, 0.5 * sin / z]
    } else {
        let w = (0.5 * (1.0 + cos)).sqrt();
        [0.0, 0.0, 0.5 * sin / w, w]
    }
}

fn encode_all(values: &[f64], out: &mut Encoder<'_>) {
    for value in values {
        out.f64(*value);
    }
}

fn decode_all<const N: usize>(input: &mut Decoder<'_>) -> Result<[f64; N], CdrError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = input.f64()?;
    }
    Ok(values)
}

/// geometry_msgs/PoseStamped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseStamped<'a> {
    /// When and in which frame.
    pub header: Header<'a>,
    /// Position, m.
    pub position: Xyz,
    /// Orientation.
    pub orientation: Quaternion,
}

impl<'a> PoseStamped<'a> {
    /// A planar pose in the frame of `header`.
    pub fn new(header: Header<'a>, pose: &Pose2) -> Self {
        Self { header, position: [pose.translation.x, pose.translation.y, 0.0], orientation: quaternion(pose) }
    }
}

impl<'a> Message<'a> for PoseStamped<'a> {
    const SCHEMA: Schema = Schema {
        name: "geometry_msgs/msg/PoseStamped",
        text: "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
        dependencies: &[HEADER, TIME, POSE, POINT, QUATERNION],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        self.header.encode(out);
        encode_all(&self.position, out);
        encode_all(&self.orientation, out);
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        Ok(Self { header: Header::decode(input)?, position: decode_all(input)?, orientation: decode_all(input)? })
    }
}

/// geometry_msgs/TwistStamped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwistStamped<'a> {
    /// When and in which frame.
    pub header: Header<'a>,
    /// Linear velocity, m/s.
    pub linear: Xyz,
    /// Angular velocity, rad/s.
    pub angular: Xyz,
}

impl<'a> Message<'a> for TwistStamped<'a> {
    const SCHEMA: Schema = Schema {
        name: "geometry_msgs/msg/TwistStamped",
        text: "std_msgs/Header header\ngeometry_msgs/Twist twist\n",
        dependencies: &[HEADER, TIME, TWIST, VECTOR3],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        self.header.encode(out);
        encode_all(&self.linear, out);
        encode_all(&self.angular, out);
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        Ok(Self { header: Header::decode(input)?, linear: decode_all(input)?, angular: decode_all(input)? })
    }
}

/// geometry_msgs/TransformStamped: pose of a child frame in the frame of the header.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TransformStamped<'a> {
    /// When and in which frame.
    pub header: Header<'a>,
    /// The child frame.
    pub child_frame_id: &'a str,
    /// Position of the child's origin, m.
    pub translation: Xyz,
    /// Orientation of the child.
    pub rotation: Quaternion,
}

impl<'a> TransformStamped<'a> {
    /// A planar pose of `child_frame_id` in the frame of `header`.
    pub fn new(header: Header<'a>, child_frame_id: &'a str, pose: &Pose2) -> Self {
        let translation = [pose.translation.x, pose.translation.y, 0.0];
        Self { header, child_frame_id, translation, rotation: quaternion(pose) }
    }
}

impl<'a> Message<'a> for TransformStamped<'a> {
    const SCHEMA: Schema = Schema {
        name: "geometry_msgs/msg/TransformStamped",
        text: TRANSFORM_STAMPED.text,
        dependencies: &[HEADER, TIME, TRANSFORM, VECTOR3, QUATERNION],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        self.header.encode(out);
        out.string(self.child_frame_id);
        encode_all(&self.translation, out);
        encode_all(&self.rotation, out);
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        Ok(Self {
            header: Header::decode(input)?,
            child_frame_id: input.string()?,
            translation: decode_all(input)?,
            rotation: decode_all(input)?,
        })
    }
}

/// tf2_msgs/TFMessage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TfMessage<'a> {
    /// One entry per child frame.
    pub transforms: Vec<TransformStamped<'a>>,
}

impl<'a> Message<'a> for TfMessage<'a> {
    const SCHEMA: Schema = Schema {
        name: "tf2_msgs/msg/TFMessage",
        text: "geometry_msgs/TransformStamped[] transforms\n",
        dependencies: &[TRANSFORM_STAMPED, HEADER, TIME, TRANSFORM, VECTOR3, QUATERNION],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.sequence(self.transforms.len());
        for transform in &self.transforms {
            transform.encode(out);
        }
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        // the shortest transform: stamp, two empty strings, seven doubles
        let len = input.sequence(8 + 2 * 5 + 7 * 8)?;
        let transforms = (0..len).map(|_| TransformStamped::decode(input)).collect::<Result<_, _>>()?;
        Ok(Self { transforms })
    }
}

/// visualization_msgs/Marker without textures and meshes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Marker<'a> {
    /// When and in which frame.
    pub header: Header<'a>,
    /// Group of the marker.
    pub ns: &'a str,
    /// Number within its group; the pair replaces an earlier marker.
    pub id: i32,
    /// Shape: one of the constants.
    pub kind: i32,
    /// 0 add or modify, 2 delete, 3 delete all.
    pub action: i32,
    /// Position, m.
    pub position: Xyz,
    /// Orientation.
    pub orientation: Quaternion,
    /// Extent along each axis, m; of a line strip only x, its width.
    pub scale: Xyz,
    /// Red, green, blue, opacity, each 0 to 1.
    pub color: [f32; 4],
    /// Points of a line strip relative to the pose, m.
    pub points: Vec<Xyz>,
    /// Text shown.
    pub text: &'a str,
}

impl Marker<'_> {
    /// A ball.
    pub const SPHERE: i32 = 2;
    /// An upright cylinder.
    pub const CYLINDER: i32 = 3;
    /// Segments from point to point.
    pub const LINE_STRIP: i32 = 4;
}

impl<'a> Message<'a> for Marker<'a> {
    const SCHEMA: Schema = Schema {
        name: "visualization_msgs/msg/Marker",
        text: MARKER.text,
        dependencies: &[
            HEADER,
            TIME,
            POSE,
            POINT,
            QUATERNION,
            VECTOR3,
            COLOR,
            DURATION,
            COMPRESSED_IMAGE,
            UV_COORDINATE,
            MESH_FILE,
        ],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        self.header.encode(out);
        out.string(self.ns);
        out.i32(self.id);
        out.i32(self.kind);
        out.i32(self.action);
        encode_all(&self.position, out);
        encode_all(&self.orientation, out);
        encode_all(&self.scale, out);
        for part in self.color {
            out.f32(part);
        }
        Stamp::default().encode(out); // lifetime: for ever
        out.bool(false); // frame_locked
        out.sequence(self.points.len());
        for point in &self.points {
            encode_all(point, out);
        }
        out.sequence(0); // colors
        out.string(""); // texture_resource
        Header::default().encode(out); // texture
        out.string("");
        out.bytes(&[]);
        out.sequence(0); // uv_coordinates
        out.string(self.text);
        out.string(""); // mesh_resource
        out.string(""); // mesh_file
        out.bytes(&[]);
        out.bool(false); // mesh_use_embedded_materials
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        let header = Header::decode(input)?;
        let ns = input.string()?;
        let (id, kind, action) = (input.i32()?, input.i32()?, input.i32()?);
        let (position, orientation, scale) = (decode_all(input)?, decode_all(input)?, decode_all(input)?);
        let color = [input.f32()?, input.f32()?, input.f32()?, input.f32()?];
        Stamp::decode(input)?;
        input.bool("frame_locked")?;
        let len = input.sequence(24)?;
        let points = (0..len).map(|_| decode_all(input)).collect::<Result<_, _>>()?;
        for _ in 0..4 * input.sequence(16)? {
            input.f32()?; // colors
        }
        input.string()?; // texture_resource
        Header::decode(input)?;
        input.string()?;
        input.bytes()?;
        for _ in 0..2 * input.sequence(8)? {
            input.f32()?; // uv_coordinates
        }
        let text = input.string()?;
        input.string()?; // mesh_resource
        input.string()?; // mesh_file
        input.bytes()?;
        input.bool("mesh_use_embedded_materials")?;
        Ok(Self { header, ns, id, kind, action, position, orientation, scale, color, points, text })
    }
}

/// visualization_msgs/MarkerArray.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MarkerArray<'a> {
    /// The markers.
    pub markers: Vec<Marker<'a>>,
}

impl<'a> Message<'a> for MarkerArray<'a> {
    const SCHEMA: Schema = Schema {
        name: "visualization_msgs/msg/MarkerArray",
        text: "visualization_msgs/Marker[] markers\n",
        dependencies: &[
            MARKER,
            HEADER,
            TIME,
            POSE,
            POINT,
            QUATERNION,
            VECTOR3,
            COLOR,
            DURATION,
            COMPRESSED_IMAGE,
            UV_COORDINATE,
            MESH_FILE,
        ],
    };

    fn encode(&self, out: &mut Encoder<'_>) {
        out.sequence(self.markers.len());
        for marker in &self.markers {
            marker.encode(out);
        }
    }

    fn decode(input: &mut Decoder<'a>) -> Result<Self, CdrError> {
        // the shortest marker: ten doubles and more
        let len = input.sequence(80)?;
        let markers = (0..len).map(|_| Marker::decode(input)).collect::<Result<_, _>>()?;
        Ok(Self { markers })
    }
}
