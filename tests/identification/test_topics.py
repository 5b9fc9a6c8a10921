"""Whether a topic says where a vehicle is to be goes by whole words of its name."""

from __future__ import annotations

import pytest

from radmpc.importing.logs.topics import is_reference


@pytest.mark.parametrize(
    "leaf",
    [
        *("ref", "pose/ref", "pose_ref", "pose-ref", "poseRef", "refPose", "POSE_REF", "ref1/pose"),
        *("reference", "references/pose", "setpoint_position/local", "setpoint_raw/target_local"),
        *("local_position_setpoint", "trajectorySetpoint", "desired_pose", "goal", "PoseGoal"),
        *("cmd_vel", "commanded_position", "command/trajectory", "REFPose", "pose.target"),
    ],
)
def test_a_topic_with_a_word_for_it_is_a_reference(leaf: str) -> None:
    assert is_reference(leaf)


@pytest.mark.parametrize(
    "leaf",
    [
        *("preferred/pose", "refined_pose", "odom_prefiltered", "mocap/pose", "referee/odom"),
        *("refraction", "goalkeeper/pose", "commander/odom", "targeting_pod/pose", "odometry"),
        *("refinedPose", "vehicle_local_position", ""),
    ],
)
def test_a_topic_with_such_letters_within_a_word_is_none(leaf: str) -> None:
    assert not is_reference(leaf)
