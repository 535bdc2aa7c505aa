"""How events are read, as stamps and rows tell it: of all pixels, without light or simulation."""

from voltcam_simulator import Parameters

from ..health import Inspection


def as_read(inspection: Inspection, parameters: Parameters) -> tuple[Parameters, list[str]]:
    """The parameters with `readout` and `arbiter_scan` as the recording shows them, and what was found."""
    notes = []
    if (bus := inspection.bus) is not None:
        found = {"row_us": round(bus.row_us, 3), "event_us": round(bus.event_us, 4)}
        parameters = parameters.changed({"readout": found})
        notes.append(
            f"the bus takes {bus.row_us:.2f} us for a row and {bus.event_us:.2f} us for an event, by "
            f"{bus.stretches} stretches in which it is never idle"
        )
    if (token := inspection.token_scan) is not None:
        parameters = parameters.changed({
            "arbiter_scan": {
                "round_us": round(token.round_us, 1),
                "share": round(token.share, 3),
                "episode_us": round(token.episode_us),
            }
        })  # fmt: skip
        notes.append(
            f"in {token.share:.0%} of the time a token goes round the rows, once in {token.round_us:.0f} us, "
            f"in stretches of {token.episode_us / 1000:.0f} ms"
        )
    return parameters, notes
