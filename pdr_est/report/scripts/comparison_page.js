/** Make a comparison page one that can be explored; if that fails, its still pictures and tables remain. */
'use strict';

/** Show the table of walks, and the tracks of the one that is chosen. */
function startWalks(data) {
  const tracks = createWalkTracks({ map: byId('walk-map'), title: byId('walk-name'), legend: byId('walk-lines'),
    values: byId('walk-values') }, data);
  const names = ['metric', 'rows', 'keys', 'search', 'reset', 'meaning', 'aligned', 'count', 'table', 'pages'];
  const parts = Object.fromEntries(names.map((name) => [name, byId(`walks-${name}`)]));
  let begun = false;
  const table = createWalkTable(parts, data, (row, metric) => {
    tracks.show(row, metric);
    if (begun) bringIntoView(byId('walk-map'));
  });
  byId('walk-before').addEventListener('click', () => table.step(-1));
  byId('walk-after').addEventListener('click', () => table.step(1));
  table.choose(table.order()[0]);
  begun = true;
}

/** Start everything on the page. */
function startComparisonPage() {
  const root = document.documentElement;
  root.classList.add('scripted');
  try {
    const data = readComparison(byId('comparison-data').textContent);
    for (const place of document.querySelectorAll('[data-curve]')) {
      createCurveChart(place, data.curves[place.dataset.curve]);
    }
    document.querySelectorAll('table.sortable').forEach(makeSortable);
    explainDefinitions();
    if (data.walks.length) startWalks(data);
  } catch (error) {
    root.classList.remove('scripted');
    throw error;
  }
}

startComparisonPage();
