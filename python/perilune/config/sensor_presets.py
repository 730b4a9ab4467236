"""Ready sensors (`camera.sensor.preset`): their values and where they come from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

Name = Literal["cmv4000", "ccd47_20", "imx174", "mastcam_z", "msl_mardi"]


class Preset(NamedTuple):
    """Keys of the section `sensor` with their sources; `assumed` lists what no source gives.

    A section given beside a preset replaces the preset's section as a whole."""

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
    "imx174": Preset(
        source="EMVA 1288 measurements of Sony's IMX174 (monochrome) by FLIR (Point Grey): 5.86 um "
        "pixels, 32691 electrons, temporal dark noise 6.83 electrons, 77 % at 525 nm",
        assumed="typical of its kind: f/4 lens, gain that fills 12 bits with the full well, black "
        "level, quantum efficiency of the red and blue band, dark current, response "
        "non-uniformity",
        values={
            "pixel_um": 5.86,
            "mosaic": "mono",
            "quantum_efficiency": [0.58, 0.77, 0.66],
            "full_well_e": 32691.0,
            "read_noise_e": 6.83,
            "dark_current_e_s": 5.0,
            "prnu": 0.005,
            "gain_e_dn": 8.1,
            "black_level_dn": 60.0,
            "bits": 12,
        },
    ),
    "mastcam_z": Preset(
        source="Bell et al. 2021 (Space Science Reviews 217, 24), table 5, the left camera at its "
        "widest: KAI-2020CM (interline, Bayer filters), 7.4 um pixels, f/6.7, 15.6 electrons a "
        "digital number, 22 electrons of noise, 21826 electrons, 11 bits, times up to 838.8 s in "
        "steps of 0.1 ms",
        assumed="typical of its kind: quantum efficiency of the bands, order of the filters, black "
        "level, dark current, response non-uniformity, a drain that takes all excess",
        values={
            "f_number": 6.7,
            "pixel_um": 7.4,
            "mosaic": "rggb",
            "quantum_efficiency": [0.31, 0.37, 0.41],
            "exposure": {"min_ms": 0.1, "max_ms": 838800.0, "step_ms": 0.1},
            "full_well_e": 21826.0,
            "read_noise_e": 22.0,
            "dark_current_e_s": 30.0,
            "prnu": 0.01,
            "drain": 1.0,
            "gain_e_dn": 15.6,
            "black_level_dn": 100.0,
            "bits": 11,
        },
    ),
    "msl_mardi": Preset(
        source="Malin et al. 2017 (Earth and Space Science 4), table 1, the descent imager MARDI: "
        "KAI-2020CM (interline, Bayer filters), 7.4 um pixels, f/3, 15.8 electrons a digital "
        "number, 17.5 electrons of noise, 29454 electrons, times up to 838.8 s in steps of 0.1 ms",
        assumed="typical of its kind: 11 bits as of mastcam_z, quantum efficiency of the bands, "
        "order of the filters, black level, dark current, response non-uniformity, a drain that "
        "takes all excess",
        values={
            "f_number": 3.0,
            "pixel_um": 7.4,
            "mosaic": "rggb",
            "quantum_efficiency": [0.31, 0.37, 0.41],
            "exposure": {"min_ms": 0.1, "max_ms": 838800.0, "step_ms": 0.1},
            "full_well_e": 29454.0,
            "read_noise_e": 17.5,
            "dark_current_e_s": 30.0,
            "prnu": 0.01,
            "drain": 1.0,
            "gain_e_dn": 15.8,
            "black_level_dn": 100.0,
            "bits": 11,
        },
    ),
}
