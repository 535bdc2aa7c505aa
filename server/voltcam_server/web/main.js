/** The page: what the daemon says goes into index.html, what the user sets goes to the daemon. */

import { ask, Backoff } from "./daemon.js";
import { Diagnosis } from "./diagnosis.js";
import { element } from "./element.js";
import { Live } from "./live.js";
import { buildPanel } from "./parameters.js";

const STATUS_PERIOD_MS = 1000;

const find = (id) => document.getElementById(id);
const live = new Live((version) => version > shown.version && refresh().catch(() => {})); // `watch` will say why
const diagnosis = new Diagnosis();
const backoff = new Backoff();
const shown = { version: -1, uptime_s: 0, source: "", request: {}, built: "", parameters: () => {} };
let here = false; // the daemon answered the last time

async function watch() {
  try {
    const status = await ask("status");
    if (!here || status.uptime_s < shown.uptime_s) await load();
    shown.uptime_s = status.uptime_s;
    if (!here && !document.hidden) open();
    here = true;
    find("session").hidden = true;
    backoff.reset();
    if (status.parameters_version !== shown.version) await refresh();
    showStatus(status);
  } catch (error) {
    here = false;
    close();
    find("session").hidden = !error.needsToken;
    if (error.needsToken) showState("locked", "");
    else showState("gone", `${error.message} Trying again…`);
  }
  setTimeout(watch, here ? STATUS_PERIOD_MS : backoff.next());
}

function open() {
  live.open();
  diagnosis.open();
}

function close() {
  live.close();
  diagnosis.close();
}

/** The panel, when the daemon is new or another one. */
async function load() {
  const [camera, schema] = await Promise.all([ask("camera"), ask("parameters/schema")]);
  find("camera").textContent = `${camera.name}, ${camera.width} × ${camera.height}`;
  const built = JSON.stringify([camera, schema]);
  if (built !== shown.built) shown.parameters = buildPanel(find("parameters"), schema, camera.parameters, change);
  shown.built = built;
  shown.version = -1;
}

/** Asks for a change; the answer says what holds. */
async function change(patch) {
  holds(await ask("parameters", "PATCH", patch));
}

let refreshing = null;

function refresh() {
  refreshing ??= ask("parameters")
    .then(holds)
    .finally(() => (refreshing = null));
  return refreshing;
}

/** Shows the parameters that hold. */
function holds({ parameters, parameters_version }) {
  if (parameters_version < shown.version) return; // an answer overtaken by a newer one
  shown.version = parameters_version;
  shown.parameters(parameters);
  find("version").textContent = parameters_version;
}

/** The mark in the header; and in a banner what keeps the pictures from coming. */
function showState(state, words) {
  const mark = find("source-state");
  mark.textContent = state === "gone" ? "no daemon" : state;
  mark.dataset.state = state;
  const banner = find("banner");
  if (banner.textContent !== words) banner.textContent = words; // a screen reader repeats what is set again
  banner.hidden = words === "";
}

function showStatus({ state, reason, load, source, frames, latency, uptime_s }) {
  const well = state === "running" || state === "starting";
  showState(state, well ? "" : `${state[0].toUpperCase()}${state.slice(1)}: ${reason}`);
  if (source.uri !== shown.source) find("source-uri").value = shown.source = source.uri;
  shown.request = source.request; // its fit, loop... hold for the next source too
  const size = source.granted ? `${source.granted.width} × ${source.granted.height}, ` : "";
  find("frame-about").textContent = `${size}${source.fps.toFixed(1)} frames/s`;
  showCounts({
    "packets lost": live.lost,
    "frames received": frames.received,
    "frames dropped": frames.dropped,
    "frames skipped": frames.skipped,
    load: load.toFixed(2),
    "events not drawn": live.skipped,
    "age of events": `${latency.age_ms.toFixed(1)} ms`,
    "up for": duration(uptime_s),
  });
}

function showCounts(counts) {
  const rows = Object.entries(counts).map(([name, value]) =>
    element("div", {}, [element("dt", {}, [name]), element("dd", {}, [String(value)])]),
  );
  find("counts").replaceChildren(...rows);
}

function duration(seconds) {
  const parts = [seconds / 3600, (seconds / 60) % 60, seconds % 60];
  return parts.map((part) => String(Math.floor(part)).padStart(2, "0")).join(":");
}

find("session").addEventListener("submit", async (event) => {
  event.preventDefault();
  try {
    await ask("session", "POST", { token: find("token").value });
    find("token").value = find("session-error").textContent = "";
    backoff.reset();
  } catch ({ message }) {
    find("session-error").textContent = message;
  }
});

find("source").addEventListener("submit", async (event) => {
  event.preventDefault();
  const [button, error] = [event.submitter, find("source-error")];
  error.textContent = "";
  button.disabled = true;
  try {
    await ask("source", "PUT", { ...shown.request, uri: find("source-uri").value.trim() });
  } catch ({ message }) {
    error.textContent = message;
  }
  button.disabled = false;
});

// A hidden page takes no stream: it costs the daemon nothing, and comes back with the newest.
document.addEventListener("visibilitychange", () => {
  if (document.hidden) close();
  else if (here) open();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => live.paint());

watch();
