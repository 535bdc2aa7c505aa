/** The two streams into the two pictures and the rate, drawn once for each frame of the screen. */

import { Stream } from "./daemon.js";
import { EventPicture, FramePicture } from "./pictures.js";
import { Rate, short } from "./rate.js";

const QUEUE_LIMIT_BYTES = 16e6; // two million events: a page that far behind skips to the newest
const EVENT_BYTES = 8;

const find = (id) => document.getElementById(id);

export class Live {
  /** What went missing: packets by their `seq`, and events this page was too slow to draw. */
  lost = 0;
  skipped = 0;
  #seq = null;
  #queue = [];
  #queued = 0; // bytes in it
  #frame = null; // the newest not yet drawn: [header, buffer]
  #drawn = performance.now();
  #picture = new EventPicture(find("events"));
  #source = new FramePicture(find("frame"));
  #rate = new Rate(find("sparkline"));

  /** onVersion(parameters_version) for each packet. */
  constructor(onVersion) {
    this.onVersion = onVersion;
    this.streams = [
      new Stream("events?encoding=libcaer", this.#onPacket, () => (this.#seq = null)),
      new Stream("frames", (header, buffer) => (this.#frame = [header, buffer])),
    ];
    this.paint();
    requestAnimationFrame(this.#draw);
  }

  open() {
    for (const stream of this.streams) stream.open();
  }

  close() {
    for (const stream of this.streams) stream.close();
  }

  /** Takes the colours of the style sheet, which follow the system's light or dark. */
  paint() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    const rgb = (name) => [1, 3, 5].map((i) => parseInt(colour(name).slice(i, i + 2), 16));
    this.#picture.paint(rgb("canvas"), rgb("on"), rgb("off"));
    this.colours = { on: colour("on"), off: colour("off"), line: colour("line") };
  }

  #onPacket = (header, buffer) => {
    const seq = Number(header.seq);
    if (this.#seq !== null && seq > this.#seq + 1) this.lost += seq - this.#seq - 1;
    this.#seq = seq;
    this.#picture.fit(header);
    this.#queue.push(buffer);
    this.#queued += buffer.byteLength;
    while (this.#queued > QUEUE_LIMIT_BYTES) {
      const { byteLength } = this.#queue.shift();
      this.#queued -= byteLength;
      this.skipped += byteLength / EVENT_BYTES;
    }
    this.onVersion(header.parameters_version);
  };

  #draw = (time) => {
    for (const buffer of this.#queue) this.#rate.add(this.#picture.add(buffer));
    [this.#queue, this.#queued] = [[], 0];
    this.#picture.draw(Math.exp(-(time - this.#drawn) / Number(find("accumulation").value)));
    this.#drawn = time;
    if (this.#frame) {
      this.#source.draw(...this.#frame);
      this.#frame = null;
    }
    if (this.#rate.tick(time)) this.#showRate();
    requestAnimationFrame(this.#draw);
  };

  #showRate() {
    const [on, off] = this.#rate.now();
    find("rate").textContent = short(on + off);
    find("rate-on").textContent = short(on);
    find("rate-off").textContent = short(off);
    find("rate-top").textContent = short(this.#rate.draw(this.colours));
  }
}
