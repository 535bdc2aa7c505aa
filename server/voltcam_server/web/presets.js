/** Cameras to pick: of the daemon, of those with names, or of a file; and saving what holds into one. */

import { address, ask } from "./daemon.js";
import { element } from "./element.js";

const find = (id) => document.getElementById(id);

/** `changed(answer)` gets the parameters that hold after a choice. */
export function setUpPresets(changed) {
  const choose = find("preset");
  const complain = ({ message }) => (find("preset-error").textContent = message);
  choose.onchange = async () => {
    find("preset-error").textContent = "";
    const presets = await ask("presets").catch(complain);
    const wanted = presets?.[choose.value];
    if (wanted) await ask("parameters", "PATCH", wanted).then(changed).catch(complain);
    choose.value = "";
  };
  find("load").onchange = async () => {
    find("preset-error").textContent = "";
    const [file] = find("load").files;
    if (file) await ask("parameters/file", "PUT", await file.text()).then(changed).catch(complain);
    find("load").value = ""; // so that the same file may be taken again
  };
  find("save").href = address("parameters/file");
}

/** The names to choose from. */
export async function listPresets() {
  const names = Object.keys(await ask("presets"));
  const options = names.map((name) => element("option", { value: name }, [name]));
  find("preset").replaceChildren(element("option", { value: "" }, ["preset…"]), ...options);
}

/** The cameras of this daemon, where there are several. */
export async function listCameras(current) {
  const cameras = await ask("cameras");
  const choose = find("cameras");
  choose.hidden = cameras.length < 2;
  choose.replaceChildren(...cameras.map(({ name }) => element("option", { value: name }, [name])));
  choose.value = current;
  choose.onchange = () => {
    location.search = `?camera=${encodeURIComponent(choose.value)}`;
  };
}
