/** Show a walk while it happens: map, numbers, sensors, what is missing, and the report at the end. */
'use strict';

const MODE_WORDS = {
  UNKNOWN: 'not recognised', HOLDING: 'in the hand', SWING: 'swinging hand', POCKET: 'pocket', OTHER: 'elsewhere',
  TRANS: 'changing',
};
const KEPT_DELAYS = 2000;

const modeNames = JSON.parse(byId('modes').textContent);
const liveMap = createTrackMap(byId('map'), {
  modes: modeNames.map((name) => ({ name, colour: `--mode-${name.toLowerCase()}`, dashes: [] })),
});
const liveTrack = createLiveTrack(liveMap);
const livePlans = JSON.parse(byId('plans').textContent).map(({ floor, name, plan }) => (
  { floor, name, layer: addMapBackground(liveMap.leaflet, plan) }));
const liveDelays = [];
let pressed_ms = null;

const link = createLink(take, (open, reason) => {
  byId('state').textContent = open ? 'connected' : `connection lost: trying again${reason ? ` (${reason})` : ''}`;
  if (open) { byId('notes').replaceChildren(); liveTrack.clear(); phone.reconnect(); }
});
const phone = createPhone(link, (words) => { byId('phone-state').textContent = words; });

function take(message) {
  if (message.type === 'poses') takePoses(message);
  else if (message.type === 'fixes') liveTrack.setFixes(message.fixes);
  else if (message.type === 'notes') message.notes.forEach(addNote);
  else if (message.type === 'status') showStatus(message);
  else if (message.type === 'state') showState(message);
  else if (message.type === 'joined') showJoined(message.device);
  else if (message.type === 'refused') phone.stop(`Not sending: ${message.reason}.`);
}

function showJoined(device) {
  byId('phone-state').textContent = `Sending as ${device}. Keep this page open and the screen on.`;
}

function takePoses(message) {
  liveTrack.add(message.poses);
  showNumbers();
  if (!Number.isFinite(message.made_s)) return;
  requestAnimationFrame(() => setTimeout(() => {  // after the frame with these poses has been drawn
    const delay_s = link.now_s() - message.made_s;
    if (!Number.isFinite(delay_s)) return;
    liveDelays.push(1000 * delay_s);
    if (liveDelays.length > KEPT_DELAYS) liveDelays.shift();
    byId('delay').textContent = `${Math.round(1000 * delay_s)} ms`;
  }, 0));
}

function showNumbers() {
  const name = liveTrack.main();
  const row = liveTrack.last(name);
  if (!row) return;
  const axes = ellipseAxes(row[5], row[6], row[7]);
  byId('way').textContent = `${liveTrack.way_m(name).toFixed(1)} m`;
  byId('radius').textContent = axes ? `${axes.long.toFixed(1)} m` : '–';
  byId('place').textContent = `${row[3].toFixed(1)}, ${row[4].toFixed(1)} m`;
  byId('mode').textContent = MODE_WORDS[modeNames[row[10]]] || '–';
}

function showStatus(status) {
  byId('steps').textContent = status.phones.length ? status.phones.map((one) => one.steps).join(' + ') : '–';
  byId('filter-delay').textContent = status.latency_s ? `${status.latency_s.toFixed(1)} s` : '–';
  showPlanOf(status.height ? status.height.floor : 0);
  byId('floor-box').hidden = !status.height;
  if (status.height) byId('floor').textContent = floorText(status.height);
  byId('missing').replaceChildren(...status.missing.map((words) => makeElement('li', {}, words)));
  byId('missing-box').hidden = status.missing.length === 0;
  byId('phones').replaceChildren(...status.phones.map((one) => {
    const rates = one.sensors.map(sensorText).join(', ') || 'nothing yet';
    const cells = [rates, `${one.steps} steps`].map((text) => makeElement('td', {}, text));
    return makeElement('tr', {}, makeElement('th', {}, one.name), ...cells);
  }));
}

/** Show the plan of the floor with a number, counted from that of the start; a plan without one is always shown. */
function showPlanOf(number) {
  for (const { floor, layer } of livePlans) {
    if (floor === null || floor === number) layer.addTo(liveMap.leaflet); else layer.remove();
  }
}

/** Write the floor, by its name on the plans if it has one, and the height, such as 2, +7.1 ± 0.4 m. */
function floorText({ floor, height_m, sigma_m }) {
  const known = livePlans.find((one) => one.floor === floor);
  const height = `${height_m < 0 ? '−' : '+'}${Math.abs(height_m).toFixed(1)} ± ${sigma_m.toFixed(1)} m`;
  return `${known ? known.name : floor}, ${height}`;
}

function sensorText({ name, rate_hz, samples }) {
  return `${name} ${rate_hz ? `${rate_hz.toFixed(0)} Hz` : `silent after ${samples} samples`}`;
}

function showState(message) {
  const ended = message.state !== 'walking';
  document.body.dataset.state = message.state;
  byId('stop').disabled = ended;
  byId('here').disabled = ended;
  if (ended) byId('sensors').disabled = true;
  if (message.state === 'ending') byId('state').textContent = 'the walk has ended: smoothing it';
  if (message.state !== 'ended') return;
  byId('state').textContent = message.report ? 'the walk has ended' : 'the walk has ended: no report, see the notes';
  if (!message.report || !byId('report').hidden) return;
  byId('report-link').href = message.report;
  byId('report-frame').src = message.report;
  byId('report').hidden = false;
  setTimeout(() => { liveMap.leaflet.invalidateSize(); liveMap.fit(); }, 100);  // the map has another size now
}

function addNote(words) {
  byId('notes-box').hidden = false;
  byId('notes').prepend(makeElement('li', {}, words));
}

showPlanOf(0);
byId('sensors').addEventListener('click', () => { byId('sensors').disabled = true; phone.start(); });
byId('stop').addEventListener('click', () => { if (confirm('End the walk?')) link.send({ type: 'stop' }); });
byId('here').addEventListener('click', () => {
  if (!byId('sigma').reportValidity()) return;
  pressed_ms = performance.now();
  byId('here-hint').hidden = false;
});
liveMap.leaflet.on('click', (event) => {
  if (pressed_ms === null || !byId('sigma').reportValidity()) return;
  if (!link.isOpen()) { byId('phone-state').textContent = 'No connection: tap again when there is one.'; return; }
  const ago_s = (performance.now() - pressed_ms) / 1000;
  const sigma_m = Number(byId('sigma').value);
  link.send({ type: 'fix', x_m: event.latlng.lng, y_m: event.latlng.lat, sigma_m, ago_s });
  pressed_ms = null;
  byId('here-hint').hidden = true;
});
