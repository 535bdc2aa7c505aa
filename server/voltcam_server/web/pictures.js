/** The two pictures: events that fade, and the source frame. Both write 32-bit RGBA pixels. */

import { baseUs, each } from "./events.js";

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

/** What pixels had last, on the camera's clock: it fades as that goes on, and stays while the camera waits. */
export class LastEvents extends Picture {
  resize(width, height) {
    super.resize(width, height);
    this.last = new Float64Array(width * height).fill(-Infinity); // [us]
    this.polarity = new Uint8Array(width * height);
    this.newest = -Infinity; // [us]
  }

  /** Adds a buffer in the `libcaer` encoding. Returns [ON, OFF] counts. */
  add(buffer, header) {
    const base = baseUs(header);
    if (base < this.newest) this.resize(this.width, this.height); // a clock that goes back is another one
    this.newest = base;
    const { last, polarity, width } = this;
    const count = [0, 0];
    each(buffer, width, this.height, (x, y, on, us) => {
      const pixel = y * width + x;
      this.happened(pixel, base + us);
      last[pixel] = this.newest = base + us;
      polarity[pixel] = on;
      count[1 - on]++;
    });
    return count;
  }

  /** An event, before it is the pixel's last. */
  happened() {}
}

/** Events, each fading exponentially; a pixel has the colour of its last polarity. */
export class EventPicture extends LastEvents {
  windowMs = 33;

  resize(width, height) {
    super.resize(width, height);
    this.activity = new Float32Array(width * height); // events, faded until the last one
  }

  happened(pixel, us) {
    this.activity[pixel] = 1 + this.activity[pixel] * Math.exp((this.last[pixel] - us) / (1000 * this.windowMs));
  }

  share(level) {
    return 1 - Math.exp(-level * EVENTS_AT_FULL);
  }

  draw(windowMs) {
    this.windowMs = windowMs;
    const { activity, last, newest, polarity, palette, pixels } = this;
    const perUs = 1 / (1000 * windowMs);
    const scale = LEVELS / EVENTS_AT_FULL;
    for (let i = 0; i < pixels.length; i++) {
      const level = activity[i] * Math.exp((last[i] - newest) * perUs) * scale;
      pixels[i] = palette[polarity[i] * LEVELS + (Math.min(LEVELS - 1, level) | 0)];
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
