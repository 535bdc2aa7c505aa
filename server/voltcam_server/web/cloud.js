/** Events of the last 50 ms in space and time, to be turned with the pointer or the arrow keys. */

import { baseUs, each } from "./events.js";
import { Picture } from "./pictures.js";

const SPAN_US = 50_000;
const CAPACITY = 1 << 17; // of the newest events
const FINENESS = 2; // points of the picture to a pixel of the sensor
const LINE = 0xff808080;
const TURN = 0.01; // radians for each pixel of the pointer

export class Cloud extends Picture {
  x = new Uint16Array(CAPACITY);
  y = new Uint16Array(CAPACITY);
  on = new Uint8Array(CAPACITY);
  t = new Float64Array(CAPACITY);
  #next = 0;
  #newest = 0;
  #yaw = -0.7;
  #pitch = 0.35;

  resize(width, height) {
    super.resize(FINENESS * width, FINENESS * height);
    [this.width, this.height] = [width, height];
    this.t?.fill(-Infinity);
  }

  add(buffer, header) {
    const base = baseUs(header);
    const count = [0, 0];
    each(buffer, this.width, this.height, (x, y, on, us) => {
      const i = this.#next++ % CAPACITY;
      this.x[i] = x;
      this.y[i] = y;
      this.on[i] = on;
      this.t[i] = base + us;
      count[1 - on]++;
      this.#newest = base + us;
    });
    return count;
  }

  /** By pixels of the screen. */
  turn(right, down) {
    this.#yaw += TURN * right;
    this.#pitch = Math.max(-1.5, Math.min(1.5, this.#pitch + TURN * down));
  }

  draw() {
    const { pixels, palette } = this;
    const [columns, rows] = [this.canvas.width, this.canvas.height];
    pixels.fill(palette[0]);
    const place = this.#projection();
    this.#frames(place);
    const half = palette.length / 2;
    for (let i = 0; i < CAPACITY; i++) {
      const age = (this.#newest - this.t[i]) / SPAN_US;
      if (!(age >= 0 && age < 1)) continue;
      const [x, y] = place(this.x[i], this.y[i], age);
      if (x >= 0 && x < columns && y >= 0 && y < rows)
        pixels[y * columns + x] = palette[this.on[i] * half + (((1 - 0.8 * age) * (half - 1)) | 0)];
    }
    this.show();
  }

  /** place(x, y, age) on the picture, age from 0 (now) to 1. */
  #projection() {
    const { width, height } = this;
    const [cos, sin] = [Math.cos(this.#yaw), Math.sin(this.#yaw)];
    const [up, along] = [Math.cos(this.#pitch), Math.sin(this.#pitch)];
    const scale = FINENESS * 0.62;
    const [middleX, middleY] = [this.canvas.width / 2, this.canvas.height / 2];
    return (x, y, age) => {
      const [a, b, c] = [x - width / 2, y - height / 2, (0.5 - age) * width];
      const away = c * cos - a * sin;
      return [(middleX + scale * (a * cos + c * sin)) | 0, (middleY + scale * (b * up + away * along)) | 0];
    };
  }

  /** The sensor now and 50 ms ago, and the corners' way between. */
  #frames(place) {
    const { width, height } = this;
    const corners = [[0, 0], [width, 0], [width, height], [0, height]];
    corners.forEach(([x, y], i) => {
      const [nextX, nextY] = corners[(i + 1) % 4];
      for (const age of [0, 1]) this.#line(place(x, y, age), place(nextX, nextY, age));
      this.#line(place(x, y, 0), place(x, y, 1));
    });
  }

  #line([x0, y0], [x1, y1]) {
    const [columns, rows] = [this.canvas.width, this.canvas.height];
    const steps = Math.max(Math.abs(x1 - x0), Math.abs(y1 - y0), 1);
    for (let i = 0; i <= steps; i++) {
      const x = (x0 + ((x1 - x0) * i) / steps) | 0;
      const y = (y0 + ((y1 - y0) * i) / steps) | 0;
      if (x >= 0 && x < columns && y >= 0 && y < rows) this.pixels[y * columns + x] = LINE;
    }
  }
}
