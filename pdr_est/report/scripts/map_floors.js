/** Show the floors of a walk one at a time: the plan of a floor, and the parts of the tracks on it. */
'use strict';

/**
 * Let the reader choose the floor that a map shows; it follows the time cursor, and the cursor follows the choice.
 *
 * @param element  where the choice is put
 * @param floors  [{name, plan, spans_s}], the lowest first: the plan as for addMapBackground, and the begins and ends
 *   of the times on the floor
 * @param map  of createTrackMap
 * @param cursor  of createTimeCursor
 */
function addFloorChoice(element, floors, map, cursor) {
  const plans = floors.map(({ plan }) => addMapBackground(map.leaflet, plan));
  plans.forEach((plan) => plan.remove());
  const isOn = ({ spans_s: spans }, time_s) => spans.some(([begin_s, end_s]) => time_s >= begin_s && time_s < end_s);
  let present = null;

  function show(number) {
    if (present !== null) plans[present].remove();
    present = number;
    plans[number].addTo(map.leaflet);
    map.showTimes((time_s) => isOn(floors[number], time_s));
    buttons[number].checked = true;
  }

  function follow() {
    if (present !== null && isOn(floors[present], cursor.time_s)) return;
    const number = floors.findIndex((floor) => isOn(floor, cursor.time_s));
    if (number >= 0 || present === null) show(Math.max(number, 0));
  }

  const buttons = floors.map(({ spans_s: spans }, number) => {
    const button = makeElement('input', { type: 'radio', name: 'floor' });
    button.addEventListener('change', () => {
      show(number);
      if (!isOn(floors[number], cursor.time_s)) cursor.setTime(spans[0][0]);
    });
    return button;
  });
  const labels = floors.map(({ name }, number) => makeElement('label', {}, buttons[number], name));
  const group = makeElement('span', { className: 'floors' }, 'floor', ...labels);
  group.setAttribute('role', 'radiogroup');
  group.setAttribute('aria-label', 'Floor');
  element.append(group);
  cursor.onTime(follow);
  follow();
}
