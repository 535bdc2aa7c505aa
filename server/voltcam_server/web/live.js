/** The two streams into the pictures and the rate, drawn once for each frame of the screen. */

import { Cloud } from "./cloud.js";
import { Stream } from "./daemon.js";
import { EventPicture, FramePicture } from "./pictures.js";
import { Pixel } from "./pixel.js";
import { Rate, short } from "./rate.js";
import { Histogram, TimeSurface } from "./views.js";

const QUEUE_LIMIT_BYTES = 16e6; // two million events: a page that far behind skips to the newest
const EVENT_BYTES = 8;
const BUNDLE_MS = 20; // a thousand messages a second are dear to a browser
const DRAW_MS = 25; // every second frame of a usual screen: the camera on the same machine needs it more
const VIEWS = { fade: EventPicture, surface: TimeSurface, histogram: Histogram, cloud: Cloud };

const find = (id) => document.getElementById(id);

export class Live {
  /** What went missing: packets by their `seq`, and events this page was too slow to draw. */
  lost = 0;
  skipped = 0;
  #seq = null;
  #queue = []; // [buffer, header] not yet in the picture
  #queued = 0; // bytes in it
  #frame = null; // the newest not yet drawn: [header, buffer]
  #drawn = performance.now();
  #canvas = find("events");
  #size = { width: 346, height: 260 };
  #view = new EventPicture(this.#canvas);
  #source = new FramePicture(find("frame"));
  #rate = new Rate(find("rate-plot"));
  #pixel = new Pixel();
  #paused = false;

  /** onVersion(parameters_version) for each packet. */
  constructor(onVersion) {
    this.onVersion = onVersion;
    this.streams = [
      new Stream(`events?encoding=libcaer&bundle_ms=${BUNDLE_MS}`, this.#onPacket, () => (this.#seq = null)),
      new Stream("frames", (header, buffer) => (this.#frame = [header, buffer])),
    ];
    this.paint();
    find("view").onchange = () => this.#look();
    find("pause").onclick = () => this.pause();
    find("pixel-close").onclick = () => this.#pixel.choose(null);
    this.#listen();
    requestAnimationFrame(this.#draw);
  }

  open() {
    for (const stream of this.streams) stream.open();
  }

  close() {
    for (const stream of this.streams) stream.close();
  }

  /** Holds the pictures still, or lets them go on. The camera goes on in any case. */
  pause() {
    this.#paused = !this.#paused;
    find("pause").textContent = this.#paused ? "Go on" : "Pause";
    find("pause").setAttribute("aria-pressed", this.#paused);
  }

  /** The next way to look. */
  nextView() {
    const choice = find("view");
    choice.selectedIndex = (choice.selectedIndex + 1) % choice.options.length;
    this.#look();
  }

  /** Takes the colours of the style sheet, which follow the system's light or dark. */
  paint() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    const rgb = (name) => [1, 3, 5].map((i) => parseInt(colour(name).slice(i, i + 2), 16));
    this.#view.paint(rgb("canvas"), rgb("on"), rgb("off"));
    this.colours = { on: colour("on"), off: colour("off"), line: colour("line"), muted: colour("muted") };
  }

  #look() {
    const { width, height } = this.#size;
    this.#view = new VIEWS[find("view").value](this.#canvas);
    this.#view.resize(width, height);
    this.paint();
  }

  #onPacket = (header, buffer) => {
    const seq = Number(header.seq);
    if (this.#seq !== null && seq > this.#seq + 1) this.lost += seq - this.#seq - 1;
    this.#seq = seq;
    this.#size = header;
    this.#view.fit(header);
    this.#queue.push([buffer, header]);
    this.#queued += buffer.byteLength;
    while (this.#queued > QUEUE_LIMIT_BYTES) {
      const [{ byteLength }] = this.#queue.shift();
      this.#queued -= byteLength;
      this.skipped += byteLength / EVENT_BYTES;
    }
    this.onVersion(header.parameters_version);
  };

  #draw = (time) => {
    requestAnimationFrame(this.#draw);
    if (time - this.#drawn < DRAW_MS) return;
    for (const [buffer, header] of this.#queue) {
      this.#rate.add(this.#view.add(buffer, header));
      this.#pixel.add(buffer, header);
    }
    [this.#queue, this.#queued] = [[], 0];
    if (!this.#paused) {
      this.#view.draw(Number(find("window").value));
      this.#pixel.draw(this.#canvas, this.#size.width, this.colours);
      if (this.#frame) this.#source.draw(...this.#frame);
      this.#frame = null;
    }
    this.#drawn = time;
    if (this.#rate.tick(time)) this.#showRate();
  };

  #showRate() {
    const [on, off] = this.#rate.now();
    find("rate").textContent = short(on + off);
    find("rate-on").textContent = short(on);
    find("rate-off").textContent = short(off);
    this.#rate.draw(this.colours);
  }

  /** The pointer and the arrow keys turn the cloud; in the other views a click looks at a pixel. */
  #listen() {
    const canvas = this.#canvas;
    canvas.onpointermove = ({ buttons, movementX, movementY }) => {
      if (buttons && this.#view.turn) this.#view.turn(movementX, movementY);
    };
    canvas.onclick = ({ offsetX, offsetY }) => {
      if (this.#view.turn) return;
      const { width, height } = this.#size;
      const share = [offsetX / canvas.clientWidth, offsetY / canvas.clientHeight];
      this.#pixel.choose([Math.floor(share[0] * width), Math.floor(share[1] * height)]);
    };
    const turns = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, -10], ArrowDown: [0, 10] };
    canvas.onkeydown = (event) => {
      if (!(event.key in turns) || !this.#view.turn) return;
      this.#view.turn(...turns[event.key]);
      event.preventDefault();
    };
  }
}
