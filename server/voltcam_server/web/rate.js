/** The event rate: counted four times a second, and a minute of it drawn, ON up and OFF down. */

const PERIOD_MS = 250;
const SAMPLES = 240;

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

  /** Draws in CSS colours; returns the rate at the edge of the drawing [1/s]. */
  draw({ on, off, line }) {
    const canvas = this.#canvas;
    const density = window.devicePixelRatio;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    [canvas.width, canvas.height] = [width * density, height * density];
    const context = canvas.getContext("2d");
    context.scale(density, density);
    const top = roundUp(Math.max(1, ...this.#samples.flat()));
    const middle = height / 2;
    const step = width / (SAMPLES - 1);
    [on, off].forEach((colour, k) => {
      context.fillStyle = colour;
      const sign = k === 0 ? -1 : 1;
      const first = SAMPLES - this.#samples.length;
      context.beginPath();
      context.moveTo(first * step, middle);
      this.#samples.forEach((sample, i) =>
        context.lineTo((first + i) * step, middle + (sign * sample[k] * middle) / top),
      );
      context.lineTo(width, middle);
      context.fill();
    });
    context.fillStyle = line;
    context.fillRect(0, middle - 0.5, width, 1);
    return top;
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
