/** Make signs of legends and options of selects, and bring parts of a page into view. */
'use strict';

/** Create the sign of a line for a legend; a colour is the name of a CSS variable, dashes are in line widths. */
function makeLineSign(colour, dashes = [], width = 2.4) {
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg');
  const path = document.createElementNS(space, 'path');
  const settings = { class: 'sign', viewBox: '0 0 24 14', 'aria-hidden': 'true' };
  Object.entries(settings).forEach(([key, value]) => svg.setAttribute(key, value));
  path.setAttribute('d', 'M1 7H23');
  path.setAttribute('stroke', `var(${colour})`);
  path.setAttribute('stroke-width', width);
  if (dashes.length) path.setAttribute('stroke-dasharray', dashes.map((part) => width * part).join(' '));
  svg.append(path);
  return svg;
}

/** Create an entry of a legend, with a box that shows or hides its line. */
function makeToggle(name, sign, onToggle, ...more) {
  const box = makeElement('input', { type: 'checkbox', checked: true });
  box.addEventListener('change', () => onToggle(box.checked));
  return makeElement('li', {}, makeElement('label', {}, box, sign, name, ...more));
}

/** Fill a <select> with options of [value, text]. */
function fillSelect(select, options) {
  select.replaceChildren(...options.map(([value, text]) => makeElement('option', { value }, text)));
}

/** Show an element whose content has just changed, if it is out of view. */
function bringIntoView(element) {
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
  element.scrollIntoView({ block: 'nearest', behavior: still ? 'auto' : 'smooth' });
}
