"""A program of dv-processing that knows nothing of Voltcam: `python algorithms.py COUNT [RECORDING]`.

So many events of a camera, which it records, or of the recording that it made; by the library's own filter,
corners, tracker and accumulator. It prints what came out, as JSON.
"""

import datetime
import hashlib
import json
import sys

import dv_processing as dv
import numpy as np

SLICE = datetime.timedelta(milliseconds=10)
RECORDED = "camera.aedat4"

count = int(sys.argv[1])
live = len(sys.argv) < 3
source = dv.io.camera.open() if live else dv.io.MonoCameraRecording(sys.argv[2])
writer = dv.io.MonoCameraWriter(RECORDED, source) if live else None

resolution = source.getEventResolution()
noise = dv.noise.BackgroundActivityNoiseFilter(resolution, datetime.timedelta(milliseconds=5))
corners = dv.features.ArcCornerDetector(resolution, 10_000, False)
tracker = dv.features.EventFeatureLKTracker.RegularTracker(resolution)
tracker.setFramerate(100)
tracker.setNumberOfEvents(5000)
accumulator = dv.Accumulator(resolution)
found = {"name": source.getCameraName(), "all": 0, "kept": 0, "corners": 0, "tracks": 0, "image": ""}
everywhere = np.full(resolution[::-1], 255, np.uint8)


def look(events: dv.EventStore) -> None:
    noise.accept(events)
    kept = noise.generateEvents()
    found["all"] += events.size()
    found["kept"] += kept.size()
    found["corners"] += len(corners.detect(kept, (0, 0, *resolution), everywhere))
    accumulator.accept(kept)
    image = accumulator.generateFrame().image
    found["image"] = hashlib.sha256(found["image"].encode() + image.tobytes()).hexdigest()
    found["contrast"] = float(image.std())
    tracker.accept(kept)
    while (result := tracker.runTracking()) is not None:
        found["tracks"] += len(result.keypoints)


slicer = dv.EventStreamSlicer()
slicer.doEveryTimeInterval(SLICE, look)
seen = 0
while source.isRunning() and seen < count:
    batch = source.getNextEventBatch()
    if batch is None:
        continue
    seen += batch.size()
    if writer is not None:
        writer.writeEvents(batch)
    slicer.accept(batch)
sys.stdout.write(json.dumps(found) + "\n")
