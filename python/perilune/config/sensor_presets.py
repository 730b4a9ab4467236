"""Ready sensors: `camera.sensor.preset`, the values of a kind and where they are from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

Name = Literal["cmv4000", "ccd47_20"]


class Preset(NamedTuple):
    """Keys of the section `sensor`; source says where they are from, assumed what is not."""

    source: str
    assumed: str
    values: Mapping[str, Any]


PRESETS: Mapping[str, Preset] = {
    "cmv4000": Preset(
        source="ams (CMOSIS) CMV4000 data sheet: pixel, full well, temporal noise, dark current "
        "and its temperature, response non-uniformity below 1 %, 12 bits",
        assumed="f/4 lens, gain that fills the bits with the full well, quantum efficiency of the "
        "bands under Bayer filters, black level, doubling of the dark current",
        values={
            "pixel_um": 5.5,
            "mosaic": "rggb",
            "quantum_efficiency": [0.38, 0.47, 0.4],
            "full_well_e": 13500.0,
            "read_noise_e": 13.0,
            "dark_current_e_s": 125.0,
            "dark_reference_c": 25.0,
            "dark_doubling_k": 6.5,
            "prnu": 0.01,
            "gain_e_dn": 3.35,
            "black_level_dn": 64.0,
            "bits": 12,
        },
    ),
    "ccd47_20": Preset(
        source="Teledyne e2v CCD47-20 data sheet (the kind of Rosetta's navigation cameras): "
        "13 um pixels, 100000 electrons, dark signal 250 electrons a second at 20 C, no "
        "anti-blooming",
        assumed="f/2.2 lens, read noise at a fast rate, gain that fills 12 bits with the full "
        "well, -20 C, a shutter (no smear), black level, quantum efficiency of the bands",
        values={
            "f_number": 2.2,
            "pixel_um": 13.0,
            "mosaic": "mono",
            "quantum_efficiency": [0.85, 0.8, 0.55],
            "full_well_e": 100000.0,
            "read_noise_e": 20.0,
            "dark_current_e_s": 250.0,
            "dark_reference_c": 20.0,
            "temperature_c": -20.0,
            "drain": 0.0,
            "gain_e_dn": 26.0,
            "black_level_dn": 200.0,
            "bits": 12,
        },
    ),
}
