/** The event rate: counted four times a second, and a minute of it drawn, ON up and OFF down. */

const PERIOD_MS = 250;
const SAMPLES = 240;
const LEFT = 58; // room for the numbers of an axis
const BOTTOM = 18;

export class Rate {
  #canvas;
  #counted = [0, 0];
  #samples = []; // [ON/s, OFF/s], oldest first
  #since = performance.now();

  constructor(canvas) {
    this.#canvas = canvas;
  }

  add([on, off]) {
    this.#counted[0] += on;
    this.#counted[1] += off;
  }

  /** True when a period is over and `now` and `draw` have news. */
  tick(time) {
    const passed = time - this.#since;
    if (passed < PERIOD_MS) return false;
    this.#samples.push(this.#counted.map((count) => (count * 1000) / passed));
    this.#samples.splice(0, this.#samples.length - SAMPLES);
    this.#counted = [0, 0];
    this.#since = time;
    return true;
  }

  /** [ON/s, OFF/s] over the last second. */
  now() {
    const last = this.#samples.slice(-1000 / PERIOD_MS);
    return [0, 1].map((k) => last.reduce((sum, sample) => sum + sample[k], 0) / Math.max(1, last.length));
  }

  /** Draws a minute with its axes, in CSS colours. */
  draw({ on, off, line, muted }) {
    const canvas = this.#canvas;
    const density = window.devicePixelRatio;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    [canvas.width, canvas.height] = [width * density, height * density];
    const context = canvas.getContext("2d");
    context.scale(density, density);
    const top = roundUp(Math.max(1, ...this.#samples.flat()));
    const [right, bottom] = [width - LEFT, height - BOTTOM];
    const middle = bottom / 2;
    axes(context, { width, bottom, top, line, muted });
    const step = right / (SAMPLES - 1);
    [on, off].forEach((colour, k) => {
      context.fillStyle = colour;
      const sign = k === 0 ? -1 : 1;
      const first = SAMPLES - this.#samples.length;
      context.beginPath();
      context.moveTo(LEFT + first * step, middle);
      this.#samples.forEach((sample, i) =>
        context.lineTo(LEFT + (first + i) * step, middle + (sign * sample[k] * middle) / top),
      );
      context.lineTo(width, middle);
      context.fill();
    });
    context.fillStyle = line;
    context.fillRect(LEFT, middle - 0.5, right, 1);
  }
}

/** Lines and numbers: rates on the left, ON above 0 and OFF below it, seconds beneath. */
function axes(context, { width, bottom, top, line, muted }) {
  context.font = "11px system-ui, sans-serif";
  context.textBaseline = "middle";
  context.textAlign = "right";
  for (const share of [1, 0.5, 0, -0.5, -1]) {
    const y = (bottom / 2) * (1 - share);
    context.fillStyle = line;
    context.fillRect(LEFT, Math.min(y, bottom - 1), width - LEFT, 1);
    context.fillStyle = muted;
    const inside = Math.max(6, Math.min(bottom - 6, y));
    context.fillText(`${short(Math.abs(share) * top)}/s`, LEFT - 5, inside);
  }
  for (const seconds of [60, 45, 30, 15, 0]) {
    const x = LEFT + (width - LEFT) * (1 - seconds / 60);
    context.fillStyle = line;
    context.fillRect(Math.min(x, width - 1), 0, 1, bottom);
    context.fillStyle = muted;
    context.textAlign = seconds === 0 ? "right" : seconds === 60 ? "left" : "center";
    context.fillText(seconds ? `−${seconds} s` : "now", x, bottom + BOTTOM / 2 + 2);
  }
}

/** The next 1, 2 or 5 times a power of ten. */
function roundUp(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].find((digit) => digit * decade >= value) * decade;
}

/** 1234567 as "1.23 M". */
export function short(value) {
  if (value >= 999_500) return `${(value / 1e6).toPrecision(3)} M`;
  if (value >= 999.5) return `${(value / 1e3).toPrecision(3)} k`;
  return value.toFixed(0);
}
