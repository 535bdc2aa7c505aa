/** The section "Record": begin and end a recording on the daemon's host, and how it is going. */

import { ask } from "./daemon.js";
import { short } from "./rate.js";

const find = (id) => document.getElementById(id);

export class Recording {
  #running = false;

  constructor() {
    find("record").addEventListener("submit", async (event) => {
      event.preventDefault();
      find("record-error").textContent = "";
      const path = find("record-path").value.trim();
      const minutes = Number(find("record-rotate").value);
      const body = { path, rotate_s: minutes ? 60 * minutes : null };
      const asked = this.#running ? ask("recording", "DELETE") : ask("recording", "POST", body);
      await asked.then((status) => this.show(status)).catch(({ message }) => (find("record-error").textContent = message));
    });
  }

  /** `status.recording`. */
  show(recording) {
    this.#running = recording?.recording ?? false;
    const button = find("record-button");
    button.textContent = recording?.ending ? "Writing…" : this.#running ? "Stop" : "Record";
    button.disabled = recording?.ending ?? false;
    button.dataset.running = this.#running;
    if (!recording) return;
    const { path, events, frames, files, lost_intervals, error } = recording;
    const lost = lost_intervals ? `, ${lost_intervals} intervals lost to a slow disk` : "";
    const several = files > 1 ? ` in ${files} files` : "";
    find("record-about").textContent = `${path}: ${short(events)} events, ${frames} frames${several}${lost}`;
    if (error) find("record-error").textContent = error;
  }
}
