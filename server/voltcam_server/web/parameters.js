/** The panel of parameters, built from the JSON schema, each group an effect. */

import { Field } from "./field.js";
import { element } from "./element.js";

/**
 * Fields for `schema` inside `root`. `camera` holds the values to go back to, nested by effect;
 * `change(patch)` asks the daemon. Returns show(parameters), which shows what holds now.
 */
export function buildPanel(root, schema, camera, change) {
  const groups = Object.entries(schema.properties).filter(([, property]) => property.$ref);
  const single = Object.entries(schema.properties).filter(([, property]) => !property.$ref);
  const fields = [];

  const add = (path, property, own, base) => {
    const field = new Field(path.join("."), property, base, (value) =>
      change(path.reduceRight((inner, key) => ({ [key]: inner }), value)),
    );
    fields.push([path, field]);
    own.append(field.row);
  };

  root.replaceChildren();
  for (const [name, property] of single) add([name], property, root, camera[name]);
  for (const [effect, { $ref, description }] of groups) {
    const model = schema.$defs[$ref.split("/").at(-1)];
    const about = (description ?? model.description ?? "").split("\n")[0];
    const inside = Object.entries(model.properties ?? {});
    const open = !isOff(inside, camera[effect]);
    const own = element("details", { open, className: "group" }, [
      element("summary", { title: about }, [element("code", {}, [effect]), element("span", {}, [about])]),
    ]);
    for (const [name, inner] of inside) add([effect, name], inner, own, camera[effect]?.[name]);
    root.append(own);
  }

  return (parameters) => {
    for (const [path, field] of fields)
      field.confirm(path.reduce((inner, key) => inner?.[key], parameters));
  };
}

/** Whether the camera leaves an effect as it is by default, at 0: then its group is shown folded. */
function isOff(properties, values) {
  const asByDefault = properties.every(([name, { default: standard }]) => values?.[name] === standard);
  return asByDefault && properties.some(([, { default: standard }]) => standard === 0);
}
