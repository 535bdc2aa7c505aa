/** The section "Source": look at something else, go to a place in a recording, and what to do at its end. */

import { ask } from "./daemon.js";
import { element } from "./element.js";

const find = (id) => document.getElementById(id);

export class Source {
  #request = {}; // its fit, loop... hold for the next source too
  #shown = "";
  #duration_s = 0;

  constructor() {
    find("source").addEventListener("submit", async (event) => {
      event.preventDefault();
      event.submitter.disabled = true;
      await this.#ask({ uri: find("source-uri").value.trim(), start_s: 0 });
      event.submitter.disabled = false;
    });
    find("source-loop").onchange = () => this.#ask({ loop: find("source-loop").checked });
    find("source-place").onchange = () => this.#ask({ start_s: find("source-place").valueAsNumber });
  }

  /** `status.source`. */
  show({ uri, request, granted, position_s }) {
    if (uri !== this.#shown) find("source-uri").value = this.#shown = uri;
    this.#request = request;
    const recording = granted !== null && !granted.live && granted.kind !== "scene";
    find("place").hidden = !recording;
    if (!recording) return;
    find("source-loop").checked = request.loop;
    this.#duration_s = granted.frames && granted.fps ? granted.frames / granted.fps : 0;
    const slider = find("source-place");
    slider.max = this.#duration_s;
    if (document.activeElement !== slider || !slider.matches(":active")) slider.value = position_s ?? 0;
    find("source-position").textContent = `${(position_s ?? 0).toFixed(1)} of ${this.#duration_s.toFixed(1)} s`;
  }

  /** Buttons for a banner: what can be done where no frames come. */
  remedies(state) {
    const button = (words, change) => element("button", { type: "button", textContent: words, onclick: () => this.#ask(change) });
    const scene = button("Look at the built-in scene", { uri: "scene", start_s: 0 });
    if (state === "source lost") return [scene];
    if (state !== "ended") return [];
    return [button("Play again", { start_s: 0 }), button("Play in a loop", { start_s: 0, loop: true }), scene];
  }

  async #ask(change) {
    find("source-error").textContent = "";
    const wanted = { ...this.#request, ...change };
    await ask("source", "PUT", wanted).catch(({ message }) => (find("source-error").textContent = message));
  }
}
