/** Find and make elements of a page, and write numbers for reading. */
'use strict';

/** Find an element by its identity; null if the page has none. */
function byId(id) {
  return document.getElementById(id);
}

/** Make an element with properties and children, which are elements or texts. */
function makeElement(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in element) element[name] = value; else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** Write a number with a fixed number of decimals, a zero without sign; a dash for one that is missing. */
function numberText(value, digits) {
  if (!Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text.replace('-', '−');
}

/** Write a time: 3:05.2, 2:07:00.0, and 8.4 s for one below a minute unless it stands in a row of longer ones. */
function timeText(time_s, digits = 1, inRow = false) {
  if (Math.abs(time_s) < 60 && !inRow) return `${numberText(time_s, digits)} s`;
  const tenths = Math.round(Math.abs(time_s) * 10 ** digits);
  const whole = Math.floor(tenths / 10 ** digits);
  const rest = digits ? `.${String(tenths % 10 ** digits).padStart(digits, '0')}` : '';
  const two = (value) => String(value).padStart(2, '0');
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return `${time_s < 0 ? '−' : ''}${h ? `${h}:${two(m)}` : m}:${two(s)}${rest}`;
}

/** Wrap an angle in degrees to −180 to 180. */
function wrapDegrees(angle) {
  return angle - 360 * Math.round(angle / 360);
}
