/** The two pictures: events that fade, and the source frame. Both write 32-bit RGBA pixels. */

import { each } from "./events.js";

const LEVELS = 256;
const EVENTS_AT_FULL = 4; // where the colour scale ends

/** A canvas with one 32-bit word for each pixel. */
export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.resize(canvas.width, canvas.height);
  }

  /** width, height: of the sensor. */
  resize(width, height) {
    [this.width, this.height] = [width, height];
    [this.canvas.width, this.canvas.height] = [width, height];
    this.image = this.context.createImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
  }

  fit({ width, height }) {
    if (width !== this.width || height !== this.height) this.resize(width, height);
  }

  /** Colours as [r, g, b]; the palette has half its entries for OFF, then as many for ON, from faint to full. */
  paint(background, on, off) {
    this.palette = new Uint32Array(2 * LEVELS);
    for (let i = 0; i < LEVELS; i++) {
      const share = this.share(i / LEVELS);
      const mix = (colour) => rgba(colour.map((c, k) => background[k] + (c - background[k]) * share));
      this.palette[i] = mix(off);
      this.palette[LEVELS + i] = mix(on);
    }
  }

  share(level) {
    return level;
  }

  show() {
    this.context.putImageData(this.image, 0, 0);
  }
}

/** Events as they come, each fading exponentially; a pixel has the colour of its last polarity. */
export class EventPicture extends Picture {
  resize(width, height) {
    super.resize(width, height);
    this.activity = new Float32Array(width * height); // events, faded
    this.polarity = new Uint8Array(width * height);
  }

  /** Adds a buffer in the `libcaer` encoding. Returns [ON, OFF] counts. */
  add(buffer) {
    const { activity, polarity, width } = this;
    const count = [0, 0];
    each(buffer, width, this.height, (x, y, on) => {
      activity[y * width + x] += 1;
      polarity[y * width + x] = on;
      count[1 - on]++;
    });
    return count;
  }

  share(level) {
    return 1 - Math.exp(-level * EVENTS_AT_FULL);
  }

  /** Shows the picture, then lets it fade for the time that has passed. */
  draw(passedMs, windowMs) {
    const keep = Math.exp(-passedMs / windowMs);
    const { activity, polarity, palette, pixels } = this;
    const scale = LEVELS / EVENTS_AT_FULL;
    for (let i = 0; i < pixels.length; i++) {
      const level = Math.min(LEVELS - 1, activity[i] * scale) | 0;
      pixels[i] = palette[polarity[i] * LEVELS + level];
      activity[i] *= keep;
    }
    this.show();
  }
}

/** The newest grey frame (sensor_msgs/Image, mono8). */
export class FramePicture extends Picture {
  draw({ width, height, step }, buffer) {
    this.fit({ width, height });
    const grey = new Uint8Array(buffer);
    for (let y = 0, i = 0; y < height; y++)
      for (let x = 0; x < width; x++, i++) this.pixels[i] = 0xff000000 | (grey[y * step + x] * 0x010101);
    this.show();
  }
}

export function rgba([r, g, b]) {
  return (0xff000000 | (b << 16) | (g << 8) | r) >>> 0;
}
