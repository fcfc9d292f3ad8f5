"""How much of a library a core does in an hour, in words."""

from collections.abc import Sequence

from scenarios.library.job import Row

SECONDS_PER_HOUR = 3600.0


def throughput_words(rows: Sequence[Row]) -> str:
    """Clips and seconds of motion an hour a core, in all, and planned and danced by the time that each took."""
    hours = sum(row["times"].get("total_s", 0.0) for row in rows) / SECONDS_PER_HOUR
    if not hours > 0.0:
        return "nothing danced"
    seconds = sum(row["seconds"] or 0.0 for row in rows)
    told = [f"{len(rows) / hours:.0f} clips and {seconds / hours:.0f} s of motion an hour a core"]
    for name, stage in (("planned", "plan_s"), ("danced", "dance_s")):
        danced = [row for row in rows if row["seconds"] and stage in row["times"]]
        motion, time = sum(row["seconds"] for row in danced), sum(row["times"][stage] for row in danced)
        if time > 0.0:
            told.append(f"{name} {SECONDS_PER_HOUR * motion / time:.0f} s of motion an hour")
    return ", ".join(told)
