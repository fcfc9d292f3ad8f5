"""The clip on the command line: its file, the part to play, and what the file does not say."""

from pathlib import Path
from typing import Annotated

import typer

from sot.motion.human.world import METRES_PER_UNIT

Clip = Annotated[str, typer.Argument(help="A file (.bvh, .amc, .c3d, .mvnx, .npz) or a name of `sot list clips`.")]
Start = Annotated[float, typer.Option(help="Where in the clip to start [s].", min=0.0)]
Duration = Annotated[float | None, typer.Option(help="How much of the clip to play [s]; to its end by default.")]
Feet = Annotated[str, typer.Option(help="auto: they step if the dancer's do; dancer: high lifts last; steps; planted.")]
EditFile = Annotated[Path | None, typer.Option("--edit", help="File (.toml) of edits of the dance: docs/editing.md.")]
Contacts = Annotated[Path | None, typer.Option(help="File (.toml) of the steps, as `sot retarget -o` writes it.")]
UpAxis = Annotated[
    str | None,
    typer.Option("--up", help="Up axis of the clip's file: x, y, z, -x, -y or -z; found in the clip by default."),
]
ForwardAxis = Annotated[
    str | None,
    typer.Option("--forward", help="Axis of the clip's file to dance along; the first frame's heading by default."),
]
Unit = Annotated[
    str | None,
    typer.Option("--unit", help=f"Unit of the clip's file: {', '.join(METRES_PER_UNIT)}; found by default."),
]
MappingFile = Annotated[Path | None, typer.Option(help="File (.toml) that names the joints of an unknown skeleton.")]
FromFormat = Annotated[
    str | None,
    typer.Option("--from", help="The clip is a robot's motion in this format, a name of `sot list formats`."),
]
FrameRate = Annotated[
    float | None,
    typer.Option("--fps", help="Frame rate of a robot's motion whose file does not say it [Hz].", min=1.0, max=10000.0),
]
