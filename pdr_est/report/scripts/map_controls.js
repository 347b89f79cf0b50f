/** Make controls of a Leaflet map in local metres: a north arrow, the whole track, the place under the pointer. */
'use strict';

/** Add a control in a corner that shows an element; returns the control. */
function addMapControl(map, position, element) {
  const control = L.control({ position });
  control.onAdd = () => element;
  return control.addTo(map);
}

/** Add an arrow that points to north, which is up. */
function addNorthArrow(map) {
  const box = L.DomUtil.create('div', 'map-north');
  box.setAttribute('role', 'img');
  box.setAttribute('aria-label', 'North is up');
  box.innerHTML = '<svg viewBox="0 0 20 30" aria-hidden="true"><path d="M10 1l6 15-6-3.5L4 16z"/>'
    + '<text x="10" y="29" text-anchor="middle">N</text></svg>';
  return addMapControl(map, 'topright', box);
}

/** Add a button below those that zoom. */
function addMapButton(map, sign, words, onPress) {
  const bar = L.DomUtil.create('div', 'leaflet-bar');
  const button = L.DomUtil.create('a', 'map-button', bar);
  button.href = '#';
  button.textContent = sign;
  button.title = words;
  button.setAttribute('role', 'button');
  button.setAttribute('aria-label', words);
  L.DomEvent.disableClickPropagation(bar);
  L.DomEvent.on(button, 'click', (event) => { L.DomEvent.preventDefault(event); onPress(); });
  return addMapControl(map, 'topleft', bar);
}

/** Add a line that shows the place under the pointer in metres. */
function addPointerPlace(map) {
  const line = L.DomUtil.create('div', 'map-place');
  map.on('mousemove', (event) => {
    line.textContent = `x ${event.latlng.lng.toFixed(1)} m, y ${event.latlng.lat.toFixed(1)} m`;
  });
  map.on('mouseout', () => { line.textContent = ''; });
  return addMapControl(map, 'bottomright', line);
}
