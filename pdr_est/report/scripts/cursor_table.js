/** Show what every device was doing at the time of the cursor. */
'use strict';

const CURSOR_COLUMNS = ['device', 'position (x, y)', 'sigma (long, short)', 'mode', 'step length', 'heading'];

/** Fill a table with a row for each device, which follows the time cursor. */
function fillCursorTable(table, devices, modes, cursor) {
  const cells = devices.map(() => CURSOR_COLUMNS.map((name) => {
    const cell = makeElement('td');
    cell.dataset.label = name;
    return cell;
  }));
  const head = makeElement('tr', {}, ...CURSOR_COLUMNS.map((name) => makeElement('th', {}, name)));
  table.append(makeElement('thead', {}, head));
  table.append(makeElement('tbody', {}, ...cells.map((row) => makeElement('tr', {}, ...row))));
  const show = () => devices.forEach(({ name, poses }, i) => {
    const texts = [name, ...cursorTexts(poses.at(cursor.time_s), modes)];
    texts.forEach((text, place) => { cells[i][place].textContent = text; });
  });
  cursor.onTime(show);
  show();
}

/** Say how probable each of several places is; nothing for a single one. */
function placesText(ellipses) {
  if (ellipses.length < 2) return '';
  const shares = ellipses.map(({ weight }) => `${numberText(100 * weight, 0)}\u00a0%`);
  return `; ${ellipses.length} places: ${shares.join(', ')}`;
}

function cursorTexts(pose, modes) {
  if (!pose) return CURSOR_COLUMNS.slice(1).map(() => '–');
  const [long, short] = sigmas(pose.cxx_m2, pose.cxy_m2, pose.cyy_m2);
  const heading = `${numberText(wrapDegrees(pose.heading_deg), 0)}° ± ${numberText(pose.sigma_heading_deg, 1)}°`;
  return [
    `${numberText(pose.x_m, 2)}, ${numberText(pose.y_m, 2)} m`,
    `${numberText(long, 2)}, ${numberText(short, 2)} m${placesText(pose.ellipses)}`,
    modes[pose.mode] ? modes[pose.mode].name : '–',
    pose.index ? `${numberText(pose.length_m, 2)} m` : '–',
    heading,
  ];
}
