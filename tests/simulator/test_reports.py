"""What holds for every effect on the events' way out, alone and together."""

from collections import Counter

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from voltcam_simulator import EVENT, Parameters, Simulator

from .scenes import Events, only, watch_still

KICKS = {
    "after_on": st.sampled_from([-3.0, 0.2]),
    "after_off": st.sampled_from([-0.4, 0.0, 3.0]),
    "chance": st.sampled_from([0.3, 1.0]),
    "delay_us": st.sampled_from([0, 700, 100_000]),
    "spread_decades": st.sampled_from([0, 1.0]),
}
REPORTS: dict[str, dict[str, st.SearchStrategy[float]]] = {
    "hot_pixels": {"fraction": st.sampled_from([0.01, 1.0]), "rate_hz": st.sampled_from([1, 5000])},
    "noise_pairs": {"rate_hz": st.sampled_from([1, 500]), "interval_us": st.sampled_from([1, 1000, 1e6])},
    "residual_kick": KICKS,
    "residual_coupling": KICKS,
    "crosstalk": {"coupling": st.sampled_from([0.01, 0.25])},
    "latency": {"delay_us": st.sampled_from([0, 100, 50_000]), "jitter_us": st.sampled_from([0, 10, 5000])},
    "readout": {
        "row_us": st.sampled_from([0, 0.3, 200]),
        "event_us": st.sampled_from([0, 0.083, 100]),
        "start_us": st.sampled_from([0, 1.3, 1000]),
    },
    "row_request": {"wait_us": st.sampled_from([0.3, 5, 3000])},
    "arbiter_scan": {
        "round_us": st.sampled_from([0.3, 250, 50_000]),
        "rows_together": st.sampled_from([1, 4]),
        "busy_per_us": st.sampled_from([0, 1e-6, 0.1]),
        "burst_per_us": st.sampled_from([1e-3, 1000]),
    },
    "usb_overflow": {
        "max_rate_events_per_s": st.sampled_from([1, 1e4, 1e7]),
        "buffer_events": st.integers(1, 99),
    },
    "timestamp_quantum": {"quantum_us": st.sampled_from([1, 7, 10_000])},
}
CHANGES = st.dictionaries(st.sampled_from(list(REPORTS)), st.none(), min_size=1).flatmap(
    lambda names: st.fixed_dictionaries({name: st.fixed_dictionaries(REPORTS[name]) for name in names})
)


@given(st.data())
@settings(max_examples=80, deadline=None)
def test_what_leaves_is_in_order_in_time_and_on_the_sensor(data: st.DataObject) -> None:
    """Through changes of parameters, jumps, and frames closer than the delays. Twins agree bit by bit."""
    width, height = data.draw(st.integers(1, 30)), data.draw(st.integers(1, 30))
    busy = Parameters().changed({"leak_noise": {"k6": 1e-3}, "comparator": {"theta_off": 0.5}})
    twins = [Simulator(width, height, busy, seed=1) for _ in range(2)]
    rng = np.random.default_rng(0)
    t_us, last_us = 0, -(2**62)
    quantum_us, earliest_us = 1, 0
    for _ in range(data.draw(st.integers(2, 6))):
        parameters = busy.changed(data.draw(CHANGES))
        quantum_us = max(quantum_us, parameters.timestamp_quantum.quantum_us)
        earliest_us = max(earliest_us, parameters.latency.earliest_us)
        for simulator in twins:
            simulator.parameters = parameters
        if data.draw(st.integers(0, 9)) == 0:
            t_us += data.draw(st.sampled_from([-1_000_000, 1_000_000]))
            last_us = -(2**62)
            image = rng.integers(0, 256, (height, width), np.uint8)
            for simulator in twins:
                simulator.jump(image, t_us)
        complete_us = twins[0].complete_us
        start_us, t_us = t_us, t_us + data.draw(st.sampled_from([1, 100, 4000, 200_000]))
        image = rng.integers(0, 256, (height, width), np.uint8)
        events, same = (simulator.advance(image, t_us) for simulator in twins)
        assert events.dtype == EVENT
        assert events.tobytes() == same.tobytes()
        if len(events) == 0:
            continue
        assert (np.diff(events["t"]) >= 0).all()
        assert events["t"][0] > start_us - earliest_us - quantum_us
        assert last_us <= complete_us <= events["t"][0]
        assert events["t"][-1] <= twins[0].complete_us <= t_us
        assert events["x"].max() < width
        assert events["y"].max() < height
        last_us = int(events["t"][-1])


def counted(parameters: Parameters) -> Counter[tuple[int, ...]]:
    events: Events = watch_still(Simulator(30, 30, parameters, seed=7), 5, 5, 50)
    return Counter(tuple(int(v) for v in event) for event in events.tolist())


def test_effects_draw_from_streams_of_their_own() -> None:
    hot = {"fraction": 0.05, "rate_hz": 20}
    pairs = {"rate_hz": 1, "interval_us": 1}
    both = counted(only(hot_pixels=hot, noise_pairs=pairs))
    alone = counted(only(hot_pixels=hot)) + counted(only(noise_pairs=pairs))
    assert len(alone) > 1000
    assert both == alone
