/** Show the tracks of all variants on one walk: a map, what each line is, and all metrics of the walk. */
'use strict';

const TRACK_WEIGHT_PX = 2.5;

/**
 * Create the view.
 *
 * @param parts  elements: map, title, legend, values (a table)
 * @param data  of readComparison
 * @returns show(row, metric)
 */
function createWalkTracks(parts, data) {
  const map = createTrackMap(parts.map, {});
  const values = data.variants.map(() => makeElement('span', { className: 'value' }));
  const hidden = new Set();
  const plans = data.plans.map((plan) => addMapBackground(map.leaflet, plan));
  const toggle = (name) => (on) => {
    if (on) hidden.delete(name); else hidden.add(name);
    map.show(name, on);
  };
  parts.legend.replaceChildren(...data.variants.map((variant, i) => makeToggle(variant.name,
    makeLineSign(variant.colour, variant.dashes), toggle(variant.name), values[i])));
  const truthEntry = makeToggle('truth', makeLineSign('--ink', [3, 2], 1.5), toggle('truth'));
  parts.legend.append(truthEntry);

  /** Draw the tracks of a row, and list its metrics. */
  function show(row, metric) {
    const { truth, tracks } = data.lines(row);
    const lines = data.variants.map((variant, i) => ({ name: variant.name, colour: variant.colour,
      weight: TRACK_WEIGHT_PX, dashes: variant.dashes.map((part) => TRACK_WEIGHT_PX * part), ...tracks[i] }));
    parts.title.textContent = data.nameOf(row);
    plans.forEach((plan, i) => { if (i === data.plan_of[row]) plan.addTo(map.leaflet); else plan.remove(); });
    map.setTruth(truth.x_m.length ? truth : null);
    map.setVariants(lines.filter((line) => line.x_m.length));
    hidden.forEach((name) => map.show(name, false));
    map.fit();
    truthEntry.hidden = !truth.x_m.length;
    const { unit } = data.metric(metric);
    values.forEach((place, i) => {
      place.textContent = `${formatNumber(data.value(metric, i, row))} ${unit}`.trim() + data.mark(metric, i);
    });
    showMetrics(row);
  }

  function showMetrics(row) {
    const known = data.metrics.filter(({ name }) => data.variants.some((_, i) => data.value(name, i, row) !== null));
    const head = ['metric', ...data.variants.map(({ name }) => name)];
    const headings = head.map((text, i) => makeElement('th', { className: i ? 'right' : '', scope: 'col' }, text));
    const rows = known.map(({ name, unit, text }) => {
      const title = unit ? `${name} (${unit})` : name;
      const link = text ? makeElement('a', { href: `#define-${name}` }, title) : title;
      const numbers = data.variants.map((_, i) => data.value(name, i, row));
      const best = data.best(name, numbers);
      const cells = numbers.map((value, i) => valueCell(value, i === best, data.mark(name, i)));
      return makeElement('tr', {}, makeElement('th', { scope: 'row' }, link), ...cells);
    });
    const top = makeElement('thead', {}, makeElement('tr', {}, ...headings));
    parts.values.replaceChildren(top, makeElement('tbody', {}, ...rows));
  }

  return { show };
}
