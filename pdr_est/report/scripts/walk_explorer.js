/** Make the report of a walk explorable: one time cursor links its map, its charts and its table. */
'use strict';

/** Fill the sections of the page from its data, and show them in place of the pictures. */
function exploreWalk() {
  const data = JSON.parse(byId('walk-data').textContent);
  const cursor = createTimeCursor(data.begin_s, data.end_s);
  const signals = data.signals.map(unpackSignal);
  const fixes = data.fixes.map((one) => ({ ...one, columns: unpackColumns(one.columns) }));
  const height = data.height && {
    columns: unpackColumns(data.height.columns), moves: unpackColumns(data.height.moves),
  };
  const tables = data.devices.map((one) => (
    { ...one, table: unpackColumns(one.poses), regions: one.regions && unpackColumns(one.regions) }));
  document.documentElement.classList.add('scripted');
  const map = makeWalkMap(data, tables, fixes, cursor);
  fillToggles(byId('map-toggles'), data, map);
  if (data.floors.length) addFloorChoice(byId('map-toggles'), data.floors, map, cursor);
  fillPlaybackBar(byId('playback'), cursor);
  fillWindowBar(byId('time-window'), cursor);
  const devices = tables.map((one) => ({ name: one.name, poses: posesOf(one) }));
  fillCursorTable(byId('cursor-table'), devices, data.modes, cursor);
  const charts = byId('charts');
  walkCharts(signals, tables, fixes, data.modes, height).forEach((spec) => createTimeChart(charts, spec, cursor));
  cursor.setTime(data.begin_s);
}

function unpackSignal(signal) {
  return {
    ...signal,
    segments: signal.segments.map((one) => ({ ...one, values: unpackColumn(one.values) })),
    steps_s: unpackColumn(signal.steps_s),
    cadence_per_min: unpackColumn(signal.cadence_per_min),
    runs: unpackColumns(signal.runs),
    gaps: unpackColumns(signal.gaps),
  };
}

function posesOf({ table, regions }) {
  const poses = createPoses();
  poses.append(table);
  if (regions) poses.setRegions(regions);
  return poses;
}

function makeWalkMap(data, tables, fixes, cursor) {
  const options = { north: data.north, modes: data.modes, onPick: timePicker(cursor) };
  const map = createTrackMap(byId('track-map'), options);
  map.setDevices(data.devices.map(({ name, line }) => ({ name, colour: line })));
  tables.forEach(({ name, table, regions }) => {
    map.append(name, table);
    if (regions) map.setRegions(name, regions);
  });
  if (data.truth) map.setTruth(unpackColumns(data.truth));
  map.setVariants(data.variants.map(({ name, colour, x_m, y_m }) => (
    { name, colour, ...unpackColumns({ x_m, y_m }) })));
  map.setFixes(fixes.flatMap(rowsOf));
  map.setDoubts(data.doubts.map(unpackColumns));
  map.fit();
  const background = data.background ? addMapBackground(map.leaflet, data.background) : null;
  cursor.onTime(() => map.setCursor(cursor.time_s));
  return { show: map.show, showTimes: map.showTimes, leaflet: map.leaflet, background };
}

/** Turn the columns of known positions into one object for each. */
function rowsOf({ kind, columns }) {
  const row = (i) => Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, values[i]]));
  return Array.from(columns.time_s, (_, i) => ({ kind, ...row(i) }));
}

/** Fill an element with boxes that show and hide parts of the map. */
function fillToggles(element, data, map) {
  const add = (words, colour, what) => {
    const box = makeElement('input', { type: 'checkbox', checked: true });
    box.addEventListener('change', () => {
      if (what !== 'background') map.show(what, box.checked);
      else if (box.checked) map.background.addTo(map.leaflet);
      else map.background.remove();
    });
    const dot = makeElement('span', { className: 'dot' });
    dot.style.background = `var(${colour})`;
    element.append(makeElement('label', {}, box, dot, words));
  };
  if (data.devices.length > 1) data.devices.forEach(({ name, colour }) => add(name, colour, name));
  add('95 % regions', '--muted', 'ellipses');
  if (data.fixes.length) add('known positions', '--fix', 'fixes');
  if (data.truth) add('truth', '--ink', 'truth');
  if (data.doubts.length) add('does not fit', '--warn-edge', 'doubts');
  if (map.background) add('background', '--grid', 'background');
  data.variants.forEach(({ name, colour }) => add(name, colour, name));
}

exploreWalk();
