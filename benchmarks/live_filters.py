"""How late the filters of a live stream are, measured, at the rates of depth cameras.

python benchmarks/live_filters.py
"""

import numpy as np
from rich.console import Console
from rich.table import Table

from sot.live.sensing.one_euro import OneEuro
from sot.live.sensing.paper_filters import CardinalSpline, CausalButterworth, measured_delay

RATES = (10.0, 15.0, 30.0, 50.0)


def main() -> None:
    """Print a table."""
    table = Table(box=None, padding=(0, 2, 0, 0), title="delay [ms]")
    table.add_column("filter")
    for rate in RATES:
        table.add_column(f"{rate:.0f} Hz", justify="right")
    for cutoff in (2.0, 3.0, 5.0):
        delays = [
            measured_delay(CausalButterworth(cutoff, rate), rate) if 2.0 * cutoff < rate else np.nan for rate in RATES
        ]
        table.add_row(
            f"Butterworth, {cutoff:.0f} Hz", *("-" if np.isnan(delay) else f"{1e3 * delay:.0f}" for delay in delays)
        )
    table.add_row("Cardinal spline", *(f"{1e3 * measured_delay(CardinalSpline(), rate):.0f}" for rate in RATES))
    one_euro = []
    for rate in RATES:
        smooth = OneEuro()
        one_euro.append(measured_delay(lambda x, smooth=smooth, rate=rate: smooth(x[None], 1.0 / rate)[0], rate))
    table.add_row("One-Euro", *(f"{1e3 * delay:.0f}" for delay in one_euro))
    Console().print(table)


if __name__ == "__main__":
    main()
