"""The sections `camera.bands` and `sun.spectrum` of the schema: bands and curves of wavelengths."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from perilune.base import spectra
from perilune.config.errors import fail
from perilune.config.types import FileName, Strict

WavelengthUnit = Literal["nm", "um"]
UM_PER_UNIT = {"nm": 1e-3, "um": 1.0}
LONGEST_UM = 100.0
Micrometres = Annotated[float, Field(strict=True, ge=0.01, le=LONGEST_UM)]
BandPreset = Literal["srgb", "monochrome"]
MOST_BANDS = 64


def found(value: str, info: ValidationInfo) -> str:
    """Path of a file, if the folder that paths are relative to is known."""
    find = (info.context or {}).get("path")
    if find is None:
        return value
    try:
        return str(find(value, ""))
    except FileNotFoundError as error:
        fail("", str(error).split(": : ", 1)[-1])  # the source and key are added to it


def read_curves(file: str, unit: WavelengthUnit, columns: int | None = None) -> Any:
    """Inside a validator: the table of a file, (n, 1 + columns); see spectra.read."""
    try:
        table = spectra.read(Path(file), UM_PER_UNIT[unit])
    except ValueError as error:
        fail("file", str(error))
    if columns is not None and table.shape[1] != 1 + columns:
        have = table.shape[1] - 1
        fail("file", f"{file}: {have} columns of values after the wavelength; expected {columns}")
    if not table[:, 1:].any(axis=0).all():
        fail("file", f"{file}: a column holds zeros alone")
    return table


def check_parts(table: Any, file: str, key: str = "file") -> None:
    """Inside a validator: refuses a response above 1, as in per cent, and one in the thermal
    infrared only, as for nanometres read as micrometres."""
    if table[:, 1:].max() > 1.0:
        fail(key, f"{file}: values are 0 to 1, not {table[:, 1:].max():g}")
    if table[-1, 0] > LONGEST_UM:
        text = f"a wavelength of {table[-1, 0]:g} um is more than {LONGEST_UM:g}; check its unit"
        fail(key, f"{file}: {text}")


class Spectrum(Strict):
    """Spectrum of the Sun from a file, instead of a black body."""

    file: FileName
    """File with rows of wavelength and irradiance, by ascending wavelength, separated by commas or
    blanks. Relative to this file, or data:... under PERILUNE_DATA. Only its shape matters: it is
    scaled so that its integral is `irradiance_w_m2`."""
    wavelength_unit: WavelengthUnit = "nm"
    """Unit of the wavelengths in the file."""
    irradiance_unit: Literal["W_m2_nm", "W_m2_um", "mW_m2_nm", "relative"] = "W_m2_nm"
    """Unit of the irradiance in the file, at 1 au. The integral must be within a tenth of 1361
    W/m2, which reveals a wrong unit or an incomplete spectrum. relative: not checked."""

    @field_validator("file")
    @classmethod
    def _found(cls, value: str, info: ValidationInfo) -> str:
        return found(value, info)

    @model_validator(mode="after")
    def _whole(self, info: ValidationInfo) -> Spectrum:
        if not (info.context or {}).get("path"):
            return self
        table = read_curves(self.file, self.wavelength_unit, 1)
        scale = {"W_m2_nm": 1e3, "W_m2_um": 1.0, "mW_m2_nm": 1.0}.get(self.irradiance_unit)
        if scale is None:
            return self
        total = scale * spectra.integral(table)
        if not 0.9 <= total / 1361.0 <= 1.1:
            low, high = table[0, 0], table[-1, 0]
            text = f"{self.file} holds {total:.4g} W/m2 between {low:g} and {high:g} um"
            fail("irradiance_unit", f"{text}; the Sun has 1361 in all (relative: any)")
        return self


class QuantumEfficiency(Strict):
    """Quantum efficiency (electrons per photon) by wavelength, from a file."""

    file: FileName
    """File with rows of wavelength and efficiency, 0 to 1: one column for the mosaics mono and
    planes, else three for red, green and blue pixels. Relative to this file, or data:... under
    PERILUNE_DATA."""
    wavelength_unit: WavelengthUnit = "nm"
    """Unit of the wavelengths in the file."""

    @field_validator("file")
    @classmethod
    def _found(cls, value: str, info: ValidationInfo) -> str:
        return found(value, info)

    def check(self, columns: int, info: ValidationInfo) -> None:
        """Inside the sensor's validator: reads the file, if the folder of paths is known."""
        if not (info.context or {}).get("path"):
            return
        try:
            table = read_curves(self.file, self.wavelength_unit, columns)
        except PydanticCustomError as error:
            fail("quantum_efficiency.file", error.message())
        check_parts(table, self.file, "quantum_efficiency.file")


class Band(Strict):
    """A spectral band of a camera: its response, 0 to 1, by wavelength."""

    name: str = ""
    """Name in `Sample.meta["bands"]` and on contact sheets."""
    center_um: Micrometres | None = None
    """Central wavelength; with width_um, instead of a file."""
    width_um: Annotated[float, Field(strict=True, ge=1e-5, le=100.0)] | None = None
    """Full width of a box, or full width at half maximum of a gaussian."""
    shape: Literal["box", "gaussian"] = "box"
    """Form of the response around center_um."""
    file: FileName | None = None
    """File with rows of wavelength and response, by ascending wavelength, separated by commas or
    blanks. Relative to this file, or data:... under PERILUNE_DATA."""
    wavelength_unit: WavelengthUnit = "nm"
    """Unit of the wavelengths in the file."""

    @field_validator("file")
    @classmethod
    def _found(cls, value: str | None, info: ValidationInfo) -> str | None:
        return None if value is None else found(value, info)

    @model_validator(mode="after")
    def _one_kind(self, info: ValidationInfo) -> Band:
        if self.file is not None:
            if self.center_um is not None or self.width_um is not None:
                fail("file", "not together with center_um and width_um")
            if (info.context or {}).get("path"):
                check_parts(read_curves(self.file, self.wavelength_unit, 1), self.file)
            return self
        if self.center_um is None or self.width_um is None:
            fail("", "needs center_um and width_um, or a file")
        if self.center_um - 0.5 * self.width_um < 0.01:
            fail("width_um", "the band must begin at 0.01 um or later")
        return self


def _some(value: tuple[Band, ...]) -> tuple[Band, ...]:
    if not 1 <= len(value) <= MOST_BANDS:
        fail("", f"must have 1 to {MOST_BANDS} bands, not {len(value)}")
    names = [band.name for band in value if band.name]
    for name in names:
        if names.count(name) > 1:
            fail("", f"two bands have the name '{name}'")
    return value


def _bands_tag(value: Any) -> str:
    return "preset" if isinstance(value, str) else "list"


Bands = Annotated[
    Annotated[BandPreset, Tag("preset")]
    | Annotated[tuple[Band, ...], AfterValidator(_some), Tag("list")],
    Discriminator(_bands_tag),
]
"""Name of a preset, or a list of bands of your own."""
