"""What the command line may say about the plant: joints, feet, sensors, and what a controller of positions does."""

from typing import Annotated

import typer

PlantName = Annotated[str, typer.Option("--plant", help="torque: motors take torques; servo: joints take positions.")]
Compliance = Annotated[
    str | None,
    typer.Option(
        "--feet-compliance",
        help='Rubber between ankles and soles, "KX,KY" or "KX,KY,KZ": stiffness of a foot about x (roll), y (pitch)'
        " [N m/rad] and along z [N/m]; rigid by default.",
    ),
]
StabiliserName = Annotated[
    str,
    typer.Option(
        "--stabiliser",
        help="With --plant servo. dcm: the divergent component is fed back, and the sag of the feet is undone;"
        " dcm-steps: so, and pushes are caught by steps; dcm-adaptive: as dcm, with feet whose compliance is estimated;"
        " sag: undone alone; open: the plan as it is.",
    ),
]
StateName = Annotated[
    str,
    typer.Option(
        "--state",
        help="What the controller knows: the true state; one estimated from the sensors; footholds: that, and drift"
        " corrected by where the plan puts the feet.",
    ),
]
SensorsName = Annotated[str, typer.Option("--sensors", help="ideal, or by data sheet: bmi088, mti630.")]
