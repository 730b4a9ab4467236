"""dataset_info.json of datasets in folders: what they hold, how they were made."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from perilune.export.writers.bop_channels import label_names
from perilune.export.writers.bop_source import driven_size, provenance
from perilune.export.writers.files import json_text
from perilune.export.writers.formats.base import Format, Info
from perilune.export.writers.formats.channels import (
    Channel,
    asked_channels,
    asked_scans,
    described,
)
from perilune.export.writers.shown import main_picture
from perilune.frame.labels import object_class
from perilune.simulation import Simulation

PICTURE = "picture"
OBJECT = "obj_id"
SPACECRAFT = "spacecraft"


def rendered(fmt: Format, sim: Simulation) -> list[str]:
    """Channels that a format writes: what is asked for and it can hold, and what it needs."""
    asked = [*asked_channels(sim)[0], *asked_scans(sim)]
    every = described(sim, asked)
    own = [name for name, channel in every.items() if not fmt.problem(channel)]
    needs = [main_picture(sim) if name == PICTURE else name for name in fmt.needs]
    known = described(sim, needs)
    return list(dict.fromkeys([*own, *(name for name in needs if name in known)]))


def _box_m(sim: Simulation, name: str) -> list[list[float]]:
    """Corners of a box that holds a spacecraft at rest, in its frame, m."""
    row = sim.models[name]
    bounds = np.asarray(row.model.bounds, dtype=np.float64)
    box: list[list[float]] = (row.metres_per_unit * (bounds - row.offset)).tolist()
    return box


def _taxonomy(sim: Simulation) -> dict[str, Any]:
    taxonomy, config = sim.taxonomy, sim.config
    classes, levels = taxonomy.classes, ("kind", "object")
    instances = []
    for name, number in taxonomy.instances.items():
        entry = config.bodies.get(name) or config.spacecraft[name]
        kind = "body" if name in config.bodies else "spacecraft"
        row: dict[str, Any] = {"id": number, "name": name, "kind": kind}
        row["class"] = object_class(name, entry)
        row["class_id"] = classes["object"][row["class"]]
        if name in sim.obj_ids:
            row["obj_id"] = sim.obj_ids[name]
        if name in sim.models and not driven_size(sim, name):
            row["box_m"] = _box_m(sim, name)
        instances.append(row)
    parts = [
        {
            "id": part.id,
            "owner": part.owner,
            "name": part.name,
            "class": part.class_name,
            "class_id": classes["part"][part.class_name],
        }
        for part in taxonomy.parts
    ]
    named = {level: dict(classes[level]) for level in (*levels, "part")}
    return {"classes": named, "instances": instances, "parts": parts}


def objects(info: Info) -> list[Mapping[str, Any]]:
    """Rows of the taxonomy of all objects, spacecraft first, as in `Sample.objects`."""
    rows = [row for row in info["taxonomy"]["instances"] if OBJECT in row]
    return sorted(rows, key=lambda row: row["kind"] != SPACECRAFT)


def spacecraft(info: Info) -> list[Mapping[str, Any]]:
    """The spacecraft among them."""
    return [row for row in objects(info) if row["kind"] == SPACECRAFT]


def folder_info(fmt: Format, sim: Simulation, chunk_size: int, split: str) -> dict[str, Any]:
    """dataset_info.json, without the sums of files beside the frames: as it is read again, in the
    order of its file, so that nothing depends on who asks."""
    channels = described(sim, rendered(fmt, sim))
    names = label_names(sim, channels)
    info = {
        **provenance(sim, chunk_size, split),
        "format": fmt.name,
        "picture": main_picture(sim),
        "channels": {name: channel.entry() for name, channel in channels.items()},
        **({"labels": names} if names else {}),
        "taxonomy": _taxonomy(sim),
        **fmt.describe(sim),
    }
    found: dict[str, Any] = json.loads(json_text(info))
    return found


def channels_of(info: Info) -> dict[str, Channel]:
    """The channels of a dataset."""
    return {name: Channel(name, **entry) for name, entry in info["channels"].items()}
