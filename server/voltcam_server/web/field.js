/** One parameter: slider and number box, or a choice. It shows what the daemon confirmed. */

import { element } from "./element.js";
import { scaleOf } from "./scale.js";

export class Field {
  #name;
  #property;
  #base; // the camera's own value
  #change;
  #confirmed;
  #wanted; // the newest value not yet asked for
  #busy = false;

  /** `change(value)` resolves when the daemon took it, and has called `confirm` by then; it throws its words. */
  constructor(name, property, base, change) {
    this.#name = name;
    this.#property = property;
    this.#base = base ?? property.default;
    this.#change = change;
    this.row = this.#build();
  }

  /** The daemon says this value holds. */
  confirm(value) {
    if (value === undefined) return;
    const former = this.#confirmed;
    this.#confirmed = value;
    this.reset.disabled = value === this.#base;
    const typing = document.activeElement === this.input && this.input.value !== spell(former);
    if (this.#wanted === undefined && !(typing && !this.#busy)) this.#show();
  }

  async #ask(value) {
    this.#wanted = value;
    if (this.#busy) return;
    this.#busy = true;
    while (this.#wanted !== undefined) {
      const asked = this.#wanted;
      this.#wanted = undefined;
      this.#complain("");
      try {
        await this.#change(asked);
      } catch (error) {
        this.#complain(`Not applied. ${error.message}`);
      }
    }
    this.#busy = false;
    this.#show();
  }

  #show() {
    this.input.value = spell(this.#confirmed);
    this.row.classList.remove("asking");
    this.#slide(this.#confirmed);
  }

  #slide(value) {
    if (!this.slider) return;
    this.slider.value = this.scale.position(value);
    this.#speak(value);
  }

  /** The slider's position means nothing to a listener. */
  #speak(value) {
    this.slider.setAttribute("aria-valuetext", `${value} ${this.#property.unit ?? ""}`);
  }

  #complain(words) {
    this.error.textContent = words;
    this.input.setAttribute("aria-invalid", words !== "");
  }

  #build() {
    const id = `p-${this.#name}`;
    const { description, source, unit = "" } = this.#property;
    const key = this.#name.split(".").at(-1);
    const about = [description, limitsOf(this.#property), source && `Source: ${source}.`].filter(Boolean);

    this.input = this.#property.enum ? this.#choice(id) : this.#box(id);
    this.input.setAttribute("aria-describedby", `${id}-tip ${id}-error`);
    this.error = element("p", { id: `${id}-error`, className: "error", role: "alert" });
    this.reset = element("button", {
      type: "button",
      className: "reset",
      title: `back to the camera's value, ${this.#base}`,
      textContent: "↺",
      aria: { label: `set ${this.#name} back to the camera's value, ${this.#base}` },
      onclick: () => this.#ask(this.#base),
    });
    const tip = element(
      "div",
      { id: `${id}-tip`, className: "tip", role: "tooltip" },
      about.map((line) => element("p", {}, [line])),
    );
    const info = element("button", {
      type: "button",
      className: "info",
      textContent: "?",
      onkeydown: onEscape(() => info.blur()),
      aria: { label: `about ${this.#name}`, describedby: `${id}-tip` },
    });
    const words = description ? element("span", {}, [description.split(/[:;]/)[0]]) : "";
    const label = element("label", { htmlFor: id }, [words, element("code", {}, [key])]);
    return element("div", { className: "field" }, [
      element("div", { className: "name" }, [label, info, tip]),
      ...(this.#property.maximum === undefined ? [] : [this.#range()]),
      this.input,
      element("span", { className: "unit", textContent: unit === "1" ? "" : unit }),
      this.reset,
      this.error,
    ]);
  }

  #choice(id) {
    const options = this.#property.enum.map((each) => element("option", { value: each }, [each]));
    return element("select", { id, onchange: () => this.#ask(this.input.value) }, options);
  }

  #box(id) {
    const commit = () => {
      const text = this.input.value.trim();
      if (text === spell(this.#confirmed)) return;
      // What is no number goes as it is: the daemon says what it thinks of it.
      this.#ask(text !== "" && Number.isFinite(Number(text)) ? Number(text) : text);
    };
    return element("input", {
      id,
      type: "text",
      autocomplete: "off",
      spellcheck: false,
      onchange: commit,
      onkeydown: onEscape(() => this.#show()),
    });
  }

  #range() {
    this.scale = scaleOf(this.#property, this.#base || this.#property.default);
    const moved = () => {
      const value = this.scale.value(this.slider.valueAsNumber);
      this.input.value = spell(value);
      this.row.classList.add("asking");
      this.#speak(value);
      this.#ask(value);
    };
    this.slider = element("input", {
      type: "range",
      min: 0,
      max: this.scale.steps,
      step: 1,
      oninput: moved,
      aria: { label: this.#name },
    });
    return this.slider;
  }
}

function onEscape(act) {
  return ({ key }) => {
    if (key === "Escape") act();
  };
}

function limitsOf({ minimum, exclusiveMinimum, maximum }) {
  return maximum === undefined ? "" : `From ${minimum ?? `above ${exclusiveMinimum}`} to ${maximum}.`;
}

/** As people write it: 0.56, 1e-7. */
function spell(value) {
  return typeof value === "number" && value !== 0 && Math.abs(value) < 1e-3
    ? value.toExponential()
    : String(value);
}
