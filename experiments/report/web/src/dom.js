// Elements in one expression. Text goes in as text, never as markup.

/** element('button', {type: 'button', onclick: f}, 'Play'): `on...` are listeners, else attributes. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) {
      made.addEventListener(name.slice(2), value);
    } else if (value === true) {
      made.setAttribute(name, '');
    } else if (value !== false && value !== null && value !== undefined) {
      made.setAttribute(name, value);
    }
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

let labels = 0;

/** A control with its visible label before it. */
export function labelled(text, control) {
  control.id ||= `control-${++labels}`;
  return element('span', {class: 'field'}, element('label', {for: control.id}, text), control);
}

/** A drop-down list; options are [value, text]. */
export function dropDown(options, value, onchange) {
  const select = element('select', {onchange: () => onchange(select.value)});
  for (const [option, text] of options) {
    select.append(element('option', {value: option, selected: option === value}, text));
  }
  return select;
}

export function button(text, onclick, attributes = {}) {
  return element('button', {type: 'button', onclick, ...attributes}, text);
}

/** A number for people: `digits` significant ones; a dash where there is none. */
export function significant(value, digits = 3) {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  if (magnitude < -4 || magnitude > 5) return value.toExponential(digits - 1);
  return value.toFixed(Math.max(0, digits - 1 - magnitude));
}
