"""KITTI's optical flow: pairs of pictures, and flow as PNG of 16 bits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from perilune.export.writers.formats.base import Array, Encoded, Format, Frame, Info, Record
from perilune.export.writers.formats.channels import COLOR, Channel
from perilune.export.writers.formats.pixels import from_png, png

FLOW, OCCLUSION = "flow", "flow_occlusion"
_STEPS, _ZERO, _MOST = 64.0, 32768.0, 65535.0


def encode_flow(flow: Array, valid: Array) -> Array:
    """(H, W, 3) uint16 of the KITTI development kit: 64 u + 2^15, 64 v + 2^15, valid. What is not
    finite, or 512 pixels and longer, is not valid."""
    steps = np.rint(np.where(np.isfinite(flow), flow, 0.0) * _STEPS + _ZERO)
    good = valid & np.isfinite(flow).all(axis=2) & ((steps >= 0) & (steps <= _MOST)).all(axis=2)
    packed = np.zeros((*good.shape, 3), dtype=np.uint16)
    packed[good, :2] = steps[good]
    packed[good, 2] = 1
    return packed


def decode_flow(packed: Array) -> Array:
    """(H, W, 2): flow in pixels; nan where it is not valid."""
    flow = (packed[:, :, :2].astype(np.float64) - _ZERO) / _STEPS
    flow[packed[:, :, 2] == 0] = np.nan
    return flow


class KittiFlow(Format):
    """Flow from each frame to the next one."""

    name = "kitti-flow"
    doc = "KITTI optical flow: pairs of pictures and flow in 16 bits"
    layout = (
        "`training/image_2/NNNNNN_10.png` and `_11.png` (the next frame), "
        "`training/flow_occ/NNNNNN_10.png` (flow of all pixels that have one, 1/64 pixel, below "
        "512 pixels), `training/flow_noc/` (without those that the next frame does not see)"
    )
    reader = "torchvision (`KittiFlow`, with the folder named KittiFlow), RAFT, OpenCV"
    needs = ("picture", FLOW, OCCLUSION)
    needs_next = True

    def holds(self, channel: Channel) -> bool:
        """Pictures and flow."""
        return channel.name in (*COLOR, FLOW, OCCLUSION)

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """A pair and its flow."""
        if frame.next_picture is None:
            raise ValueError("kitti-flow: the next frame is missing")
        flow = frame.arrays[FLOW]
        every = np.ones(flow.shape[:2], dtype=bool)
        names = {
            "image_2/{}_10": frame.arrays[info["picture"]],
            "image_2/{}_11": frame.next_picture,
            "flow_occ/{}_10": encode_flow(flow, every),
            "flow_noc/{}_10": encode_flow(flow, frame.arrays[OCCLUSION] == 0),
        }
        return Encoded(
            {f"training/{name.format(frame.key)}.png": png(v) for name, v in names.items()}
        )

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """The first picture, and the flow in steps of 1/64 pixel."""
        key = f"{record['index']:06d}_10.png"
        return {
            info["picture"]: from_png(read(f"training/image_2/{key}")),
            FLOW: decode_flow(from_png(read(f"training/flow_occ/{key}"))),
        }
