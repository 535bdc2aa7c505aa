/** One pixel: what is around it, and its events of the last two seconds, ON up and OFF down. */

import { baseUs, each } from "./events.js";

const SPAN_US = 2_000_000;
const AROUND = 8; // pixels to each side
const MOST = 20_000; // events kept

const find = (id) => document.getElementById(id);

export class Pixel {
  #at = null; // [x, y]
  #events = []; // [us, on], oldest first
  #newest = 0;
  #canvas = find("pixel");

  /** Look at the pixel at (x, y); null: at none. */
  choose(at) {
    this.#at = at;
    this.#events = [];
    find("pixel-figure").hidden = at === null;
    find("frame-figure").hidden = at !== null;
    if (at) find("pixel-about").textContent = `(${at[0]}, ${at[1]})`;
  }

  add(buffer, header) {
    if (!this.#at) return;
    const [wantedX, wantedY] = this.#at;
    const base = baseUs(header);
    each(buffer, wantedX + 1, wantedY + 1, (x, y, on, us) => {
      if (x === wantedX && y === wantedY) this.#events.push([base + us, on]);
    });
    this.#newest = Math.max(this.#newest, base);
    const from = this.#events.findIndex(([us]) => us > this.#newest - SPAN_US);
    this.#events.splice(0, from < 0 ? this.#events.length : Math.max(from, this.#events.length - MOST));
  }

  /** picture: the canvas of events. Colours as in CSS. */
  draw(picture, width, { on, off, line, muted }) {
    if (!this.#at) return;
    const canvas = this.#canvas;
    const density = window.devicePixelRatio;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    [canvas.width, canvas.height] = [w * density, h * density];
    const context = canvas.getContext("2d");
    context.scale(density, density);
    context.imageSmoothingEnabled = false;
    const side = Math.min(w, h * 0.62);
    const fineness = picture.width / width;
    const [x, y] = this.#at.map((c) => (c - AROUND) * fineness);
    const reach = (2 * AROUND + 1) * fineness;
    context.drawImage(picture, x, y, reach, reach, 0, 0, side, side);
    context.strokeStyle = muted;
    const cell = side / (2 * AROUND + 1);
    context.strokeRect(AROUND * cell, AROUND * cell, cell, cell);
    this.#raster(context, w, side + 8, h - 16, { on, off, line, muted });
    const seconds = SPAN_US / 1e6;
    const ons = this.#events.filter(([, each]) => each).length;
    const rates = [ons, this.#events.length - ons].map((count) => (count / seconds).toFixed(1));
    find("pixel-rates").textContent = `ON ${rates[0]}/s, OFF ${rates[1]}/s`;
  }

  #raster(context, width, top, bottom, { on, off, line, muted }) {
    const middle = (top + bottom) / 2;
    const reach = (bottom - top) / 2 - 2;
    context.fillStyle = line;
    context.fillRect(0, middle, width, 1);
    for (const [us, up] of this.#events) {
      const x = width * (1 - (this.#newest - us) / SPAN_US);
      context.fillStyle = up ? on : off;
      context.fillRect(x, up ? middle - reach : middle, 1.5, reach);
    }
    context.fillStyle = muted;
    context.font = "11px system-ui, sans-serif";
    context.fillText("−2 s", 0, bottom + 13);
    context.textAlign = "right";
    context.fillText("now", width, bottom + 13);
  }
}
