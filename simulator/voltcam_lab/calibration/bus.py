"""How events are read, as stamps and rows tell it: of all pixels, without light or simulation."""

from voltcam_simulator import Parameters

from ..health import Inspection

WORDS = {
    "first": "rows leave in no order of an arbiter's own",
    "fair": "a fair tree says who is next",
    "greedy": "a greedy tree says who is next",
    "token": "a token goes upwards",
}


def as_read(inspection: Inspection, parameters: Parameters) -> tuple[Parameters, list[str]]:
    """The parameters with `readout` and `arbiter_scan` as the recording shows them, and what was found."""
    notes = []
    if (bus := inspection.bus) is not None:
        times = {"row_us": bus.row_us, "event_us": bus.event_us, "pass_us": bus.pass_us}
        found = {name: round(us, 4) for name, us in (times | {"start_us": bus.waits.start_us}).items()}
        parameters = parameters.changed({
            "readout": {**found, "along": bus.along, "arbiter": bus.arbiter},
            "row_request": {"wait_us": round(bus.waits.row_us, 3)},
        })  # fmt: skip
        notes.append(
            f"the bus takes {bus.row_us:.2f} us for a {bus.along[:-1]} and {bus.event_us:.2f} us for an "
            f"event, by {bus.stretches} stretches in which it is never idle; {WORDS[bus.arbiter]}"
        )
        if max(bus.waits.start_us, bus.waits.row_us) > 0:
            notes.append(
                f"a bus that was idle begins after {bus.waits.start_us:.1f} us, and a row asks for it after "
                f"{bus.waits.row_us:.1f} us"
            )
    if (token := inspection.token_scan) is not None:
        parameters = parameters.changed({
            "arbiter_scan": {
                "round_us": round(token.round_us, 1),
                "rows_together": token.rows_together,
                "busy_per_us": float(f"{token.busy_per_us:.3g}"),
                "steepness": round(token.steepness, 2),
                "burst_per_us": float(f"{token.burst_per_us:.3g}"),
            }
        })  # fmt: skip
        notes.append(token.in_words())
    return parameters, notes
