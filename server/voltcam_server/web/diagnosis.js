/** The section "Diagnose": it asks for a diagnosis, and shows the state that the daemon pushes. */

import { ask, Stream } from "./daemon.js";
import { element } from "./element.js";

const find = (id) => document.getElementById(`diagnosis-${id}`);
const ADDRESS = /^(tcp|ipc):\/\//;

export class Diagnosis {
  #stream = new Stream("diagnosis/progress", (state) => this.#show(state));

  constructor() {
    const reference = document.getElementById("reference");
    document.getElementById("diagnose").addEventListener("submit", (event) => {
      event.preventDefault();
      const wanted = reference.value.trim();
      this.#ask("diagnosis", "POST", ADDRESS.test(wanted) ? { stream: wanted } : { reference: wanted });
    });
    find("end").onclick = () => this.#ask("diagnosis", "DELETE");
    find("accept").onclick = () => this.#ask("diagnosis/accept", "POST");
    find("revert").onclick = () => this.#ask("diagnosis/revert", "POST");
  }

  open() {
    this.#stream.open();
  }

  close() {
    this.#stream.close();
  }

  async #ask(path, method, body) {
    find("error").textContent = "";
    await ask(path, method, body).catch(({ message }) => (find("error").textContent = message));
  }

  #show({ state, progress, figures, error, result, acceptable, revertible }) {
    const running = state === "gathering" || state === "running";
    find("start").disabled = running;
    find("end").hidden = !running;
    find("accept").hidden = !acceptable;
    find("revert").hidden = !revertible;
    find("report").hidden = state !== "done";
    find("verdict").textContent = result?.sentence ?? "";
    if (error) find("error").textContent = error;
    showProgress(progress);
    find("rates").hidden = !figures || state === "done";
    if (figures) showRates(figures);
  }
}

/** Follows the newest sentence, unless the reader has scrolled up. */
function showProgress(sentences) {
  const log = find("progress");
  const text = sentences.join("\n");
  if (log.textContent === text) return;
  const atEnd = log.scrollTop + log.clientHeight >= log.scrollHeight - 4;
  log.textContent = text;
  if (atEnd) log.scrollTop = log.scrollHeight;
}

function showRates({ seconds, frames, events, strata }) {
  const cell = (rate) => element("td", {}, [rate.toFixed(2)]);
  const rows = strata.map(({ from_dn, to_dn, here, reference }) =>
    element("tr", {}, [
      element("th", { scope: "row" }, [`${from_dn} to ${to_dn}`]),
      ...[here.on, here.off, reference.on, reference.off].map(cell),
    ]),
  );
  find("rates").tBodies[0].replaceChildren(...rows);
  const so_far = `${seconds.toFixed(1)} s, ${frames} frames, ${events} events of the reference`;
  find("rates").caption.textContent = `Events per second and pixel. Gathered: ${so_far}.`;
}
