/** The panel of parameters, built from the JSON schema: effects by what they are about, each with its switch. */

import { Field } from "./field.js";
import { element } from "./element.js";

const ABOUT = [
  ["pixel", "Pixel", "thresholds, response, leaks"],
  ["noise", "Noise", "what comes without a change of light"],
  ["readout", "Readout", "from the pixel to the computer"],
  ["light", "Light", "from the scene to the sensor"],
];

/**
 * Fields for `schema` inside `root`. `camera` holds the values to go back to, nested by effect; `spare` values
 * to switch an effect on with that the camera has off; `change(patch)` asks the daemon. Returns
 * { show(parameters), search(words) }: show what holds now; show only what has to do with the words.
 */
export function buildPanel(root, schema, camera, spare, change) {
  const single = Object.entries(schema.properties).filter(([, property]) => !property.$ref);
  const fields = [];
  const add = (path, property, own, base) => {
    const field = new Field(path.join("."), property, base, (value) =>
      change(path.reduceRight((inner, key) => ({ [key]: inner }), value)),
    );
    fields.push([path, field]);
    own.append(field.row);
  };

  const chapters = Object.fromEntries(
    ABOUT.map(([about, title, words]) => {
      const heading = element("h3", {}, [title, element("small", {}, [words])]);
      return [about, element("section", { className: "chapter" }, [heading])];
    }),
  );
  root.replaceChildren(...Object.values(chapters));
  for (const [name, property] of single) add([name], property, chapters.pixel, camera[name]);
  const effects = Object.entries(schema.properties)
    .filter(([, property]) => property.$ref)
    .map(([name, { $ref, description }]) => {
      const model = schema.$defs[$ref.split("/").at(-1)];
      const effect = new Effect(name, model, description, camera[name] ?? {}, spare[name], change);
      for (const [key, property] of Object.entries(model.properties ?? {}))
        add([name, key], property, effect.row, camera[name]?.[key]);
      chapters[model.about].append(effect.row);
      return effect;
    });

  return {
    show(parameters) {
      for (const [path, field] of fields)
        field.confirm(path.reduce((inner, key) => inner?.[key], parameters));
      for (const effect of effects) effect.show(parameters[effect.name]);
    },
    search(words) {
      const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
      for (const row of root.querySelectorAll(".group, .chapter > .field")) {
        const text = row.textContent.toLowerCase();
        row.hidden = !wanted.every((word) => text.includes(word));
        if (wanted.length && !row.hidden && row.tagName === "DETAILS") row.open = true;
      }
      for (const chapter of root.children)
        chapter.hidden = !chapter.querySelector(".group:not([hidden]), .field:not([hidden])");
    },
  };
}

/** One effect: a group that folds, with a switch where its defaults leave it off. */
class Effect {
  #off;
  #on; // what to switch it on with
  #now;

  constructor(name, model, description, camera, spare, change) {
    this.name = name;
    const about = (description ?? model.description ?? "").split("\n")[0];
    const defaults = Object.entries(model.properties ?? {}).map(([key, property]) => [key, property.default]);
    this.#off = model.off_by_default ? Object.fromEntries(defaults) : null;
    this.#on = [camera, spare].find((values) => values && !this.#isOff(values));
    const summary = element("summary", { title: about }, [
      element("span", { className: "title" }, [name.replaceAll("_", " ")]),
      element("code", {}, [name]),
      element("span", { className: "words" }, [about]),
    ]);
    if (this.#off) summary.prepend(this.#switch(change));
    this.row = element("details", { open: !this.#isOff(camera), className: "group" }, [summary]);
  }

  show(values) {
    this.#now = values;
    const on = !this.#isOff(values);
    if (on && this.#off) this.#on = values;
    this.row.dataset.on = on;
    if (!this.toggle) return;
    this.toggle.checked = on;
    this.toggle.disabled = !on && !this.#on;
    this.toggle.title = on ? "on" : this.#on ? "off" : "off: it goes on with one of its values";
  }

  #isOff(values) {
    return this.#off !== null && Object.entries(this.#off).every(([key, value]) => values?.[key] === value);
  }

  #switch(change) {
    this.toggle = element("input", { type: "checkbox", className: "switch", aria: { label: `${this.name} on` } });
    this.toggle.setAttribute("role", "switch");
    this.toggle.onclick = (event) => event.stopPropagation(); // it does not fold the group
    this.toggle.onchange = async () => {
      const wanted = this.toggle.checked ? this.#on : this.#off;
      await change({ [this.name]: wanted }).catch(() => this.show(this.#now));
    };
    return this.toggle;
  }
}
