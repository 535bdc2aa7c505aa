/**
 * Ways to look at events, on one canvas. Each has add(buffer, header), which returns [ON, OFF] counts, and
 * draw(windowMs). The first, events that fade, is `EventPicture`.
 */

import { baseUs, each } from "./events.js";
import { LastEvents, Picture, rgba } from "./pictures.js";

const SURFACE_LEVELS = 256;
const MIXED = 32; // levels of each colour in a mixture

/** Time surface: how long ago each pixel had its last event, exp(-age / window), by its polarity. */
export class TimeSurface extends LastEvents {
  draw(windowMs) {
    const { last, polarity, palette, pixels, newest } = this;
    const perUs = 1 / (1000 * windowMs);
    for (let i = 0; i < pixels.length; i++) {
      const share = Math.exp((last[i] - newest) * perUs);
      pixels[i] = palette[polarity[i] * SURFACE_LEVELS + ((share * (SURFACE_LEVELS - 1)) | 0)];
    }
    this.show();
  }
}

/** Counts of ON and OFF in each window, one colour channel mix each, at rest until the next window is full. */
export class Histogram extends Picture {
  resize(width, height) {
    super.resize(width, height);
    this.counts = new Uint16Array(2 * width * height);
    this.since = -Infinity; // [us]
  }

  add(buffer, header) {
    const { counts, width } = this;
    const base = baseUs(header);
    if (base - this.since > 1000 * this.windowMs) {
      if (this.since > 0) this.#develop();
      counts.fill(0);
      this.since = base;
    }
    const count = [0, 0];
    each(buffer, width, this.height, (x, y, on) => {
      counts[2 * (y * width + x) + on]++;
      count[1 - on]++;
    });
    return count;
  }

  /** Colours mixed by how many of each there were; only a few pixels are beyond the scale. */
  #develop() {
    const { counts, pixels, mixed } = this;
    const sample = Array.from({ length: 2000 }, (_, i) => counts[Math.floor((i * counts.length) / 2000)]);
    const perLevel = (MIXED - 1) / Math.max(2, sample.sort((a, b) => a - b)[1990]);
    for (let i = 0; i < pixels.length; i++) {
      const on = Math.min(MIXED - 1, counts[2 * i + 1] * perLevel) | 0;
      const off = Math.min(MIXED - 1, counts[2 * i] * perLevel) | 0;
      pixels[i] = mixed[on * MIXED + off];
    }
  }

  paint(background, on, off) {
    super.paint(background, on, off);
    this.mixed = new Uint32Array(MIXED * MIXED);
    for (let i = 0; i < MIXED * MIXED; i++) {
      const [ons, offs] = [Math.floor(i / MIXED) / (MIXED - 1), (i % MIXED) / (MIXED - 1)];
      const mix = (c, k) => c + (on[k] - c) * ons + (off[k] - c) * offs;
      this.mixed[i] = rgba(background.map((c, k) => Math.max(0, Math.min(255, mix(c, k)))));
    }
  }

  draw(windowMs) {
    this.windowMs = windowMs;
    this.show();
  }
}
