"""What a camera on the robot sees of its room: PyBullet's software renderer, in a world of pictures only."""

import itertools
import math
from typing import Final

import numpy as np
import pybullet as _bullet

from grader.contracts.assignment import Room, Solid
from grader.sim.bullet import Client
from grader.sim.car import PlanarPose

WIDTH: Final = 80
HEIGHT: Final = 60
"""Pixels: a millisecond to draw, where 320 by 240 take thirteen."""

CAMERA_X_M: Final = 0.076
CAMERA_Z_M: Final = 0.103
# The Burger's camera in Gazebo sees 3.18 rad, which no plane picture can.
ACROSS_RAD: Final = 2.0
_NEAR_M, _FAR_M = 0.03, 20.0
_STRIPE_M: Final = 0.002  # how high a line's picture lies over the floor's
_FLOOR: Final = (0.78, 0.77, 0.74, 1.0)
_COLOURS: Final = {
    "edge": (0.55, 0.65, 0.85, 1.0),
    "wall": (0.55, 0.65, 0.85, 1.0),
    "box": (0.85, 0.45, 0.25, 1.0),
    "cylinder": (0.35, 0.65, 0.35, 1.0),
    "ramp": (0.7, 0.7, 0.5, 1.0),
}


class RoomCamera(Client):
    """Draws one room. It is apart from the physics, so that looking changes no bit of the motion."""

    def __init__(self, room: Room) -> None:
        super().__init__("a client for pictures")
        x, y = (room.left_m + room.right_m) / 2.0, (room.bottom_m + room.top_m) / 2.0
        half = ((room.right_m - room.left_m) / 2.0, (room.top_m - room.bottom_m) / 2.0, 0.05)
        self._show(_bullet.GEOM_BOX, (x, y, -0.05), 0.0, _FLOOR, halfExtents=half)
        for stripe in room.stripes:
            for (x0, y0), (x1, y1) in itertools.pairwise(stripe.points_m):
                length_m = math.hypot(x1 - x0, y1 - y0) + stripe.width_m
                size = (length_m / 2.0, stripe.width_m / 2.0, _STRIPE_M)
                middle, heading_rad = ((x0 + x1) / 2.0, (y0 + y1) / 2.0, 0.0), math.atan2(y1 - y0, x1 - x0)
                self._show(_bullet.GEOM_BOX, middle, heading_rad, (*stripe.colour, 1.0), halfExtents=size)
        for solid in room.solids:
            self._stand(solid)
        up_deg = math.degrees(2.0 * math.atan(math.tan(ACROSS_RAD / 2.0) * HEIGHT / WIDTH))
        self._lens = _bullet.computeProjectionMatrixFOV(up_deg, WIDTH / HEIGHT, _NEAR_M, _FAR_M)

    def picture(self, pose: PlanarPose) -> bytes:
        """Return what the camera of a robot in this pose sees: rows from the top, three bytes a pixel (rgb8)."""
        x, y, heading = pose
        c, s = math.cos(heading), math.sin(heading)
        eye = (x + CAMERA_X_M * c, y + CAMERA_X_M * s, CAMERA_Z_M)
        view = _bullet.computeViewMatrix(eye, (eye[0] + c, eye[1] + s, CAMERA_Z_M), (0.0, 0.0, 1.0))
        _, _, pixels, *_ = _bullet.getCameraImage(
            WIDTH,
            HEIGHT,
            view,
            self._lens,
            shadow=0,
            lightDirection=(0.3, 0.2, 1.0),
            renderer=_bullet.ER_TINY_RENDERER,
            flags=_bullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self._client,
        )
        drawn = np.asarray(pixels, dtype=np.uint8).reshape(HEIGHT, WIDTH, 4)
        return np.ascontiguousarray(drawn[:, :, :3]).tobytes()

    def _stand(self, solid: Solid) -> None:
        at = (solid.x_m, solid.y_m, solid.height_m / 2.0)
        heading_rad, colour = math.radians(solid.heading_deg), _COLOURS[solid.kind]
        if solid.kind == "cylinder":
            size = {"radius": solid.length_m / 2.0, "length": solid.height_m}
            self._show(_bullet.GEOM_CYLINDER, at, heading_rad, colour, **size)
        else:
            # a ramp is drawn as the flat box it covers: its slope tells a camera little
            half_height_m = solid.height_m / (4.0 if solid.kind == "ramp" else 2.0)
            half = (solid.length_m / 2.0, solid.width_m / 2.0, half_height_m)
            self._show(
                _bullet.GEOM_BOX, (solid.x_m, solid.y_m, half_height_m), heading_rad, colour, halfExtents=half
            )

    def _show(
        self,
        shape: int,
        at: tuple[float, float, float],
        heading_rad: float,
        colour: tuple[float, ...],
        **size: object,
    ) -> None:
        visual = _bullet.createVisualShape(shape, rgbaColor=colour, physicsClientId=self._client, **size)
        quaternion = (0.0, 0.0, math.sin(heading_rad / 2.0), math.cos(heading_rad / 2.0))
        _bullet.createMultiBody(0.0, -1, visual, at, quaternion, physicsClientId=self._client)
