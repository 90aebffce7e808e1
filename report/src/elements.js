// Makes elements of the page. Text is always text, never markup: reports may come from anywhere.

const svgNamespace = "http://www.w3.org/2000/svg";

function filled(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

export const byId = (id) => document.getElementById(id);
export const element = (name, attributes = {}, ...children) =>
  filled(document.createElement(name), attributes, children);
export const shape = (name, attributes = {}, ...children) =>
  filled(document.createElementNS(svgNamespace, name), attributes, children);

// A little square of a colour, as an SVG so that it is printed, too.
export function swatch(colour) {
  return shape(
    "svg",
    { class: "swatch", viewBox: "0 0 10 10", "aria-hidden": "true" },
    shape("rect", { width: 10, height: 10, rx: 2, fill: colour }),
  );
}

// A row of radio buttons in the fieldset `parent`; `choose` gets the chosen option's value.
export function radioButtons(parent, options, choose) {
  for (const { value, label, checked } of options) {
    const input = element("input", { type: "radio", name: parent.id, value, id: `${parent.id}-${value}` });
    input.checked = Boolean(checked);
    input.addEventListener("change", () => choose(value));
    parent.append(input, element("label", { for: input.id }, label));
  }
}
