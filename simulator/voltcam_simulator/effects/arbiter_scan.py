"""An arbiter that goes round: a token passes over the rows; what waits in a row leaves when it comes by."""

from typing import Any, ClassVar

import numpy as np

from ..effect import About, Effect, EventInterval, Events, Sensor, State, quantity
from ..event_order import in_time_order
from ..kernel import kernel
from ..random import events_key, uniform

NS_PER_US = 1000
_MEASURED = "measured on slider_depth (DAVIS240C, Event Camera Dataset), from the events' stamps and rows"


class ArbiterScan(Effect):
    """While the token goes round, an event waits until it passes its row, from row 0 up, once in round_us;
    all that wait in a row leave with one time stamp. `readout` then takes them as a row's.

    The arbiter goes over to that for episodes and comes back, by chance here: stretches of either kind have
    exponential lengths. (In the recording episodes end with the burst that a frame's exposure makes; what
    begins them is not known to us.) The token's place is counted from the time line's zero.
    """

    about: ClassVar[About] = "readout"
    signature: ClassVar[str] = (
        "events run over the rows, round after round, many of a row with one time stamp"
    )
    steady: ClassVar[bool] = True

    round_us: float = quantity(
        0.0, unit="us", ge=0, le=100_000, meaning="time of a round over all rows; 0 is off",
        source=f"174 to 275, 246 in the middle: {_MEASURED}",
    )  # fmt: skip
    share: float = quantity(
        1.0, unit="1", gt=0, le=1, meaning="part of the time in which the token goes round; 1: always",
        source=f"0.09 in the first 2 s, 0.42 then: {_MEASURED}",
    )  # fmt: skip
    episode_us: float = quantity(
        20_000.0, unit="us", ge=100, le=1e9, meaning="mean length of an episode of going round",
        source=f"20 ms: {_MEASURED}",
    )  # fmt: skip

    @property
    def active(self) -> bool:
        return self.round_us > 0

    def state(self, sensor: Sensor) -> State:
        return {
            "round": np.zeros(2, np.bool_),  # whether it goes round; whether that has been drawn yet
            "until_us": np.zeros(1),  # when it goes over
            "draws": np.array([events_key(sensor.seed, self.name, 0)], np.uint64),
        }

    def report(self, events: Events, readout: EventInterval) -> Events:
        state = readout.state[self.name]
        rest_us = self.episode_us * (1 - self.share) / self.share
        wait(
            events, np.int64(readout.start_us), np.int64(max(round(self.round_us * NS_PER_US), 1)),
            readout.sensor.height, self.episode_us, rest_us, state["round"], state["until_us"],
            state["draws"],
        )  # fmt: skip
        return in_time_order(events)


@kernel
def wait(
    events: Any,
    start: Any,
    round_ns: Any,
    rows: Any,
    episode: Any,
    rest: Any,
    going: Any,
    until: Any,
    draws: Any,
) -> None:
    """Delay the events, in place and sorted by time, to when the token passes their rows, if it goes round.

    going (2,), until (1,) [us], draws (1,): kept between.
    """
    if not going[1]:
        going[1] = True
        draws[0], u = uniform(draws[0])
        going[0] = u * (episode + rest) < episode
        draws[0], u = uniform(draws[0])
        until[0] = start - np.log(u) * (episode if going[0] else rest)
    for i in range(events.shape[0]):
        t = events[i].t
        while rest > 0 and t >= until[0]:
            going[0] = not going[0]
            draws[0], u = uniform(draws[0])
            until[0] -= np.log(u) * (episode if going[0] else rest)
        if going[0] or rest <= 0:
            now = t * 1000
            passes = np.int64(events[i].y) * round_ns // rows
            events[i].t = (now + (passes - now) % round_ns) // 1000
