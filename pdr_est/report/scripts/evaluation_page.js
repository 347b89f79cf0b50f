/** Make the page of an evaluation explorable: a time cursor links the map of tracks and truth with the errors. */
'use strict';

/** Fill the sections of the page from its data, and show them in place of the pictures. */
function exploreEvaluation() {
  const data = JSON.parse(byId('evaluation-data').textContent);
  const cursor = createTimeCursor(data.begin_s, data.end_s);
  document.documentElement.classList.add('scripted');
  const map = makeEvaluationMap(data, cursor);
  fillPlaybackBar(byId('playback'), cursor);
  fillWindowBar(byId('time-window'), cursor);
  const series = data.devices.map(({ name, colour, errors }) => {
    const { time_s, error_m } = unpackColumns(errors);
    return { name, colour, time_s, values: error_m, width: 1.8 };
  });
  const chart = { title: 'error at the true positions', unit: 'm', digits: 2, height: 190, series };
  createTimeChart(byId('charts'), chart, cursor);
  fillDeviceToggles(byId('map-toggles'), data, map);
  cursor.setTime(data.begin_s);
}

/** Draw the tracks of all devices, the true positions, and a line from each of them to where the track was. */
function makeEvaluationMap(data, cursor) {
  // Each device is a mode of its own: the mode of a track from another program is not known.
  const modes = data.devices.map(({ name, colour }) => ({ name, colour, dashes: [] }));
  const options = { north: data.north, modes, onPick: timePicker(cursor) };
  const map = createTrackMap(byId('track-map'), options);
  map.setDevices(data.devices.map(({ name }) => ({ name, colour: null })));
  data.devices.forEach(({ name, poses }, number) => {
    const columns = unpackColumns(poses);
    map.append(name, { ...columns, mode: new Uint8Array(columns.time_s.length).fill(number) });
  });
  map.setTruth(unpackColumns(data.truth));
  if (data.points) {
    const { time_s, x_m, y_m } = unpackColumns(data.points);
    map.setFixes(Array.from(time_s, (time, i) => ({ time_s: time, x_m: x_m[i], y_m: y_m[i], kind: 'held out' })));
  }
  map.fit();
  cursor.onTime(() => map.setCursor(cursor.time_s));
  return map;
}

/** Fill an element with boxes that show and hide the devices and the truth. */
function fillDeviceToggles(element, data, map) {
  const add = (name, sign, ...what) => {
    const change = (on) => what.forEach((one) => map.show(one, on));
    element.append(makeToggle(name, sign, change));
  };
  data.devices.forEach(({ name, colour }) => add(name, makeLineSign(colour), name));
  add('truth', makeLineSign('--ink', [3, 2], 1.5), 'truth', 'fixes');
}

exploreEvaluation();
