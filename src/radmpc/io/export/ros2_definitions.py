"""ROS 2 message definitions as MCAP files carry them; these are of Humble and later."""

from __future__ import annotations

__all__ = ["MARKERS", "MARKERS_DEFINITION", "PATH", "PATH_DEFINITION"]

PATH = "nav_msgs/msg/Path"
MARKERS = "visualization_msgs/msg/MarkerArray"

_MESSAGES = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "std_msgs/ColorRGBA": "float32 r\nfloat32 g\nfloat32 b\nfloat32 a",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/Pose": ("geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation"),
    "geometry_msgs/PoseStamped": "std_msgs/Header header\ngeometry_msgs/Pose pose",
    "sensor_msgs/CompressedImage": "std_msgs/Header header\nstring format\nuint8[] data",
    "visualization_msgs/UVCoordinate": "float32 u\nfloat32 v",
    "visualization_msgs/MeshFile": "string filename\nuint8[] data",
    "visualization_msgs/Marker": "\n".join(
        [
            "std_msgs/Header header",
            "string ns",
            "int32 id",
            "int32 type",
            "int32 action",
            "geometry_msgs/Pose pose",
            "geometry_msgs/Vector3 scale",
            "std_msgs/ColorRGBA color",
            "builtin_interfaces/Duration lifetime",
            "bool frame_locked",
            "geometry_msgs/Point[] points",
            "std_msgs/ColorRGBA[] colors",
            "string texture_resource",
            "sensor_msgs/CompressedImage texture",
            "visualization_msgs/UVCoordinate[] uv_coordinates",
            "string text",
            "string mesh_resource",
            "visualization_msgs/MeshFile mesh_file",
            "bool mesh_use_embedded_materials",
        ]
    ),
}


def _definition(text: str, *names: str) -> str:
    """Return a definition followed by those it needs."""
    parts = [text, *(f"MSG: {name}\n{_MESSAGES[name]}" for name in names)]
    return f"\n{'=' * 80}\n".join(parts)


PATH_DEFINITION = _definition(
    "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses",
    "std_msgs/Header",
    "builtin_interfaces/Time",
    "geometry_msgs/PoseStamped",
    "geometry_msgs/Pose",
    "geometry_msgs/Point",
    "geometry_msgs/Quaternion",
)

MARKERS_DEFINITION = _definition(
    "visualization_msgs/Marker[] markers",
    "visualization_msgs/Marker",
    "std_msgs/Header",
    "builtin_interfaces/Time",
    "geometry_msgs/Pose",
    "geometry_msgs/Point",
    "geometry_msgs/Quaternion",
    "geometry_msgs/Vector3",
    "std_msgs/ColorRGBA",
    "builtin_interfaces/Duration",
    "sensor_msgs/CompressedImage",
    "visualization_msgs/UVCoordinate",
    "visualization_msgs/MeshFile",
)
