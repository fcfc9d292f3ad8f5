"""`sot live` and `sot stream`."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from scenarios.inputs.clip_options import MappingFile
from scenarios.inputs.disturbances import parse_mismatch, parse_push
from scenarios.live.session import LiveRequest, live
from scenarios.live.streaming import stream_clips
from scenarios.live.view import shown_live
from scenarios.showing import progress, show_report
from scenarios.terminal import DONE, output
from sot.live.streams.address import StreamAddress
from sot.motion.human.skeleton import read_mapping

STAGES = {
    "received": "since the person was there",
    "filtered": "since received",
    "solved": "since received",
    "commanded": "since received",
    "measured": "since received",
}


def live_command(
    source: Annotated[
        str, typer.Argument(help="A clip, or a stream: udp://, vmc:// or rokoko:// with HOST:PORT to listen at.")
    ],
    robot: Annotated[
        str, typer.Option("--robot", help="A name of `sot list robots`, or a robot file (.toml).")
    ] = "hrp2",
    delay: Annotated[float, typer.Option(help="Play everything so much later [s].", min=0.0, max=2.0)] = 0.0,
    duration: Annotated[float | None, typer.Option(help="How long [s]; until Ctrl-C, or the end of a clip.")] = None,
    rate: Annotated[float, typer.Option(help="Control ticks per second.", min=100.0, max=2000.0)] = 500.0,
    bind: Annotated[
        str | None, typer.Option(help="Address of the interface to listen at; without it, only this machine.")
    ] = None,
    token: Annotated[str, typer.Option(help="What frames of udp:// have to carry.")] = "",
    points: Annotated[
        str,
        typer.Option(help="Follow these points alone: waist,shoulders,elbows,wrists,head, from which a human is made."),
    ] = "",
    feet: Annotated[
        str, typer.Option(help='"planted" keeps both feet where they are, "steps" steps as the person does.')
    ] = "planted",
    mapping: MappingFile = None,
    push: Annotated[list[str] | None, typer.Option("--push", help="A push, as for `sot replay`.")] = None,
    mismatch: Annotated[str, typer.Option("--mismatch", help="As for `sot replay`.")] = "",
    view: Annotated[bool, typer.Option("--view", help="Show it in rerun's viewer while it runs.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder for what it writes; runs/live by default.")] = None,
) -> int:
    """Let a robot follow a person who moves now; record it and report on it."""
    pushes = tuple(parse_push(text) for text in push or ())
    request = LiveRequest(
        source,
        robot,
        rate=rate,
        delay=delay,
        duration=duration,
        bind=bind,
        token=token,
        pushes=pushes,
        mismatch=parse_mismatch(mismatch),
        points=points,
        feet=feet,
        mapping=read_mapping(mapping) if mapping else None,
    )
    folder = out or Path("runs") / "live"
    with shown_live(_say) if view else nullcontext() as shown, progress() as tell:
        report = live(request, folder, tell, shown)
    status = show_report(report, folder)
    show_live(report["live"])
    return status


def stream_command(
    clips: Annotated[
        list[str], typer.Argument(metavar="CLIP...", help="Files (.bvh, .amc) or names of `sot list clips`, in turn.")
    ],
    to: Annotated[str, typer.Option("--to", help="Where to: udp://, vmc:// or rokoko:// with HOST:PORT.")],
    rate: Annotated[float, typer.Option(help="Frames per second.", min=1.0, max=240.0)] = 50.0,
    start: Annotated[float, typer.Option(help="Where in each clip to start [s].", min=0.0)] = 0.0,
    duration: Annotated[
        float | None, typer.Option(help="How much of each clip to send [s]; to its end by default.")
    ] = None,
    loop: Annotated[
        float | None, typer.Option(help="Begin again and again, for so long [s]; the seams are blended.", min=0.1)
    ] = None,
    token: Annotated[str, typer.Option(help="What the receiver wants frames of udp:// to carry.")] = "",
) -> int:
    """Play clips as a live source would send them."""
    sent = stream_clips(clips, StreamAddress.parse(to), rate, start, duration, loop, token)
    output.print(f"{sent} frames sent to {to}", soft_wrap=True)
    return DONE


def _say(line: str) -> None:
    output.print(line, soft_wrap=True, highlight=False)


def show_live(figures: dict[str, Any]) -> None:
    """Print the latencies of a live run, stage by stage, and what befell its frames."""
    table = Table(box=None, padding=(0, 2, 0, 0))
    for column in ("latency [ms]", "p50", "p95", "max", ""):
        table.add_column(column, justify="left" if column in ("latency [ms]", "") else "right")
    rows = {**figures["latency_ms"], "behind the clock": figures["behind_ms"]}
    for stage, spread in rows.items():
        values = ["-" if spread[key] is None else f"{spread[key]:.1f}" for key in ("p50", "p95", "max")]
        table.add_row(stage, *values, STAGES.get(stage, "each tick"))
    output.print(table)
    if figures["lag_ms"] is not None:
        output.print(f"The robot's hands are {figures['lag_ms']:.0f} ms behind the person's.")
    if (segments := figures["upper_segments"]) is not None:
        output.print(
            f"Its upper segments are {segments['deg']:.1f}° off the person's, {segments['deg_at_lag']:.1f}° off where"
            f" the person was {segments['lag_ms']:.0f} ms before.",
            soft_wrap=True,
        )
    befell = [f"{count} {what}" for part in ("frames", "time_line", "packets") for what, count in figures[part].items()]
    output.print(f"Frames and packets: {', '.join(befell)}.", soft_wrap=True, highlight=False)
