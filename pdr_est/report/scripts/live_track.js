/** Keep the poses that arrive, of which the last one of a device and time counts, and draw them on the map. */
'use strict';

const REDRAW_AFTER_MS = 400;
const DEVICE_COLOURS = ['--series-1', '--series-2', '--series-3', '--series-4'];
const PERSON = 'fused';

/**
 * Create the track on a map by createTrackMap.
 *
 * Poses nearly always come in the order of time and are appended; where an older one changes, which late data and
 * positions do, the map is drawn again a little later.
 *
 * @returns add(rows), setFixes(rows), clear(), last(device), main(), way_m(device), fixes(), rows(device)
 */
function createLiveTrack(map) {
  const devices = new Map();
  let fixes = [];
  let waiting = 0;
  let fitted = 0;

  function add(rows) {
    let changed = false;
    const fresh = new Map();
    for (const row of rows) {
      const [name, time_s] = row;
      if (!devices.has(name)) { devices.set(name, { times: [], rows: [] }); changed = true; }
      const one = devices.get(name);
      const last = one.times.length ? one.times[one.times.length - 1] : -Infinity;
      if (time_s > last) {
        one.times.push(time_s);
        one.rows.push(row);
        if (!fresh.has(name)) fresh.set(name, []);
        fresh.get(name).push(row);
        continue;
      }
      const place = firstAfter(one.times, time_s);
      if (one.times[place - 1] === time_s) one.rows[place - 1] = row;
      else { one.times.splice(place, 0, time_s); one.rows.splice(place, 0, row); }
      changed = true;
    }
    if (changed) redrawSoon();
    else if (!waiting) fresh.forEach((some, name) => map.append(name, columnsOf(some)));
    showLast();
  }

  function redrawSoon() {
    if (!waiting) waiting = setTimeout(redraw, REDRAW_AFTER_MS);
  }

  function redraw() {
    waiting = 0;
    const names = [...devices.keys()].sort((a, b) => (a === PERSON) - (b === PERSON));
    map.setDevices(names.map((name, i) => ({
      name, colour: name === PERSON || names.length === 1 ? null : DEVICE_COLOURS[i % DEVICE_COLOURS.length],
    })));
    for (const name of names) map.append(name, columnsOf(devices.get(name).rows));
    showLast();
  }

  function showLast() {
    const row = last(main());
    if (!row) return;
    map.setCursor(row[1]);
    if (fitted === 0 || !map.leaflet.getBounds().pad(-0.1).contains([row[4], row[3]])) {
      fitted += 1;
      map.fit();
    }
  }

  function setFixes(rows) {
    fixes = [...fixes, ...rows.map(([time_s, x_m, y_m, cxx_m2, cxy_m2, cyy_m2]) => (
      { time_s, x_m, y_m, cxx_m2, cxy_m2, cyy_m2, kind: 'given' }))];
    map.setFixes(fixes);
  }

  function clear() {
    devices.clear();
    fixes = [];
    redrawSoon();
  }

  function last(name) {
    const one = devices.get(name);
    return one && one.rows.length ? one.rows[one.rows.length - 1] : null;
  }

  /** Name the track of the person, else of the first device. */
  function main() {
    return devices.has(PERSON) ? PERSON : devices.keys().next().value;
  }

  function way_m(name) {
    const { rows } = devices.get(name) || { rows: [] };
    let way = 0;
    for (let i = 1; i < rows.length; i += 1) {
      way += Math.hypot(rows[i][3] - rows[i - 1][3], rows[i][4] - rows[i - 1][4]);
    }
    return way;
  }

  return { add, setFixes, clear, last, main, way_m, fixes: () => fixes,
    rows: (name) => (devices.get(name) || { rows: [] }).rows };
}

/** Turn rows of poses, which hold the device and then POSE_COLUMNS, into the columns that a map takes. */
function columnsOf(rows) {
  return Object.fromEntries(POSE_COLUMNS.map((name, i) => [name, rows.map((row) => row[i + 1])]));
}
