"""Logs open in the readers that the rest of the world uses."""

import json
from collections import Counter
from pathlib import Path

import pytest
from example_log import write_log
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

PACKAGE = Path(__file__).resolve().parents[2] / "crates" / "core" / "msg"
ROBOTS = 6
TICKS = 100
STANDARD = {
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/TwistStamped",
    "tf2_msgs/msg/TFMessage",
    "visualization_msgs/msg/MarkerArray",
}
CUSTOM = {f"cohaul_msgs/msg/{name}" for name in ("Observation", "Decision", "Memory", "LoadState", "RobotState", "Outcome")}


@pytest.fixture(scope="session")
def mission_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log that only its own writer has touched."""
    path = tmp_path_factory.mktemp("log") / "example.mcap"
    write_log(path, ticks=TICKS)
    return path


def expected_counts() -> dict[str, int]:
    """Messages per topic of `mission_log`."""
    counts = {"/tf": TICKS, "/cohaul/markers": TICKS // 4, "/cohaul/outcome": 1}
    for robot in range(ROBOTS):
        for topic in ("observation", "decision", "cmd_vel", "state", "pose"):
            counts[f"/r{robot}/{topic}"] = TICKS
        counts[f"/r{robot}/memory"] = 1
    for topic in ("state", "pose"):
        counts[f"/loads/crate/{topic}"] = TICKS
    return counts


def test_mcap_ros2_decodes_every_topic(mission_log: Path) -> None:
    counts: Counter[str] = Counter()
    last = {}
    with mission_log.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema.encoding == "ros2msg"
            assert channel.message_encoding == "cdr"
            assert "reliability: 1" in channel.metadata["offered_qos_profiles"]
            counts[channel.topic] += 1
            last[channel.topic] = decoded
            if hasattr(decoded, "time"):
                assert decoded.time == message.log_time
        statistics = reader.get_summary().statistics
    assert counts == expected_counts()
    assert statistics.message_count == counts.total()
    assert json.loads(last["/cohaul/outcome"].json) == {"outcome": "reached", "success": True}

    observation, decision = last["/r3/observation"], last["/r3/decision"]
    assert observation.robot == decision.robot == 3
    assert observation.time - observation.sampled == 5_000_000
    pose = observation.world_from_robot
    assert pose.cos**2 + pose.sin**2 == pytest.approx(1.0, abs=1e-12)
    # the reader drops constants; `test_rosbags...` compares the names
    assert (decision.primitive, decision.role) == (2, 0)
    assert last["/r5/decision"].role == 255
    assert last["/r3/cmd_vel"].twist.linear.x == decision.linear
    assert last["/r3/cmd_vel"].twist.angular.z == decision.angular

    stamped = last["/r3/pose"]
    assert stamped.header.frame_id == "map"
    assert (stamped.pose.position.x, stamped.pose.position.y) == (pose.x, pose.y)
    # the double angle gives the rotation back
    z, w = stamped.pose.orientation.z, stamped.pose.orientation.w
    assert (w * w - z * z, 2 * w * z) == pytest.approx((pose.cos, pose.sin), abs=1e-12)

    transforms = last["/tf"].transforms
    children = [f"r{i}/base_footprint" for i in range(ROBOTS)] + ["load_crate"]
    assert [transform.child_frame_id for transform in transforms] == children
    assert transforms[3].transform.translation.x == pose.x

    markers = last["/cohaul/markers"].markers
    assert [marker.ns for marker in markers] == ["load", "waypoint"] + ["robot"] * ROBOTS
    outline = markers[0]
    assert outline.type == 4  # LINE_STRIP
    assert len(outline.points) == 5
    assert (outline.points[0].x, outline.points[0].y) == (outline.points[4].x, outline.points[4].y) == (0.5, 0.3)


def test_metadata_and_attachment_reproduce_the_run(mission_log: Path) -> None:
    with mission_log.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        (metadata,) = [record for record in reader.iter_metadata() if record.name == "cohaul"]
        (attachment,) = reader.iter_attachments()
    assert metadata.metadata["seed"] == "7"
    assert metadata.metadata["world"] == "planar"
    assert metadata.metadata["robots"] == "r0 r1 r2 r3 r4 r5"
    assert metadata.metadata["scenario_text"].startswith("schema: cohaul/1\n")
    assert attachment.name == "scenario.yaml"
    assert attachment.data.decode() == metadata.metadata["scenario_text"]


def test_topics_can_be_chosen_through_the_index(mission_log: Path) -> None:
    with mission_log.open("rb") as stream:
        reader = make_reader(stream)
        chosen = list(reader.iter_messages(topics=["/r2/pose"], starting_at=1_000_000_000, ending_before=2_000_000_000))
    assert [message.log_time for _, _, message in chosen] == list(range(1_000_000_000, 2_000_000_000, 50_000_000))


def test_rosbags_reads_every_topic_and_serialises_the_same_bytes(mission_log: Path) -> None:
    counts: Counter[str] = Counter()
    types: set[str] = set()
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    with AnyReader([mission_log]) as reader:
        for name in CUSTOM:
            (definition,) = {c.msgdef.data for c in reader.connections if c.msgtype == name}
            jazzy.register(get_types_from_msg(definition, name))
        for connection, _, raw in reader.messages():
            counts[connection.topic] += 1
            types.add(connection.msgtype)
            reader.deserialize(raw, connection.msgtype)
            message = jazzy.deserialize_cdr(raw, connection.msgtype)
            assert bytes(jazzy.serialize_cdr(message, connection.msgtype)) == bytes(raw), connection.topic
            if connection.topic == "/r3/decision":
                assert message.primitive == message.PRIMITIVE_TRANSLATE
                assert message.role == message.ROLE_PUSH
                assert message.phase == message.PHASE_WORK
                assert message.fault == message.FAULT_NONE
            if connection.topic == "/cohaul/markers":
                shapes = [marker.type for marker in message.markers]
                marker = message.markers[0]
                assert shapes == [marker.LINE_STRIP, marker.SPHERE] + [marker.CYLINDER] * ROBOTS
    assert counts == expected_counts()
    assert types == STANDARD | CUSTOM


def test_definitions_are_those_of_jazzy_and_of_the_package(mission_log: Path) -> None:
    jazzy = get_typestore(Stores.ROS2_JAZZY)
    with AnyReader([mission_log]) as reader:
        for connection in reader.connections:
            if connection.msgtype in STANDARD:
                text, _ = jazzy.generate_msgdef(connection.msgtype, ros_version=2)
                assert definitions(connection.msgdef.data) == definitions(text)
            else:
                name = connection.msgtype.removeprefix("cohaul_msgs/msg/")
                for dependency, text in definitions(connection.msgdef.data).items():
                    file = dependency.removeprefix("cohaul_msgs/") or name
                    assert text == (PACKAGE / "msg" / f"{file}.msg").read_text().strip()


def definitions(text: str) -> dict[str, str]:
    """Concatenated definitions by type; the first is the type itself."""
    first, *others = text.split("=" * 80 + "\nMSG: ")
    named = (other.split("\n", 1) for other in others)
    return {"": first.strip(), **{name: body.strip() for name, body in named}}


def test_rosbag2_reads_the_bare_file(mission_log: Path) -> None:
    with Reader(mission_log) as reader:
        assert reader.message_count == sum(expected_counts().values())
        (profile,) = {str(c.ext.offered_qos_profiles[0].reliability) for c in reader.connections}
    assert "RELIABLE" in profile


def test_package_lists_every_message() -> None:
    build = (PACKAGE / "CMakeLists.txt").read_text()
    files = {f"msg/{path.name}" for path in (PACKAGE / "msg").iterdir()}
    assert {word for word in build.split() if word.endswith(".msg")} == files
    store = get_typestore(Stores.EMPTY)
    for name in files:
        store.register(get_types_from_msg((PACKAGE / name).read_text(), f"cohaul_msgs/{name[:-4]}"))
