/** Show one metric of every walk and variant in a table that can be filtered, sorted and paged. */
'use strict';

const FIRST_COLUMNS = 2;  // the walk, and how far it is off

/**
 * Create the table.
 *
 * @param parts  elements: metric, rows (selects), keys (place of the filters), search, reset, meaning, aligned
 *   (or null), count, table, pages
 * @param data  of readComparison
 * @param onChoose  called with the row that the reader chose
 * @returns choose(row), step(by): choose the row before or after in the present order, and order()
 */
function createWalkTable(parts, data, onChoose) {
  const state = { metric: data.first_metric, column: 1, direction: -1, page: 0, chosen: -1, order: [] };
  const filters = data.keys.map((key) => ({ key, select: addFilter(parts.keys, key) }));
  const head = parts.table.createTHead();
  const body = parts.table.createTBody();
  fillSelect(parts.metric, data.metrics.map(({ name, unit }) => [name, unit ? `${name} (${unit})` : name]));
  parts.metric.value = state.metric;

  parts.metric.addEventListener('change', () => { state.metric = parts.metric.value; chooseAgain(); });
  parts.rows.addEventListener('change', () => { state.page = 0; showRows(); });
  parts.search.addEventListener('input', refresh);
  filters.forEach(({ select }) => select.addEventListener('change', refresh));
  parts.reset.addEventListener('click', () => {
    filters.forEach(({ select }) => { select.value = ''; });
    parts.search.value = '';
    refresh();
  });
  body.addEventListener('click', (event) => {
    const row = event.target.closest('tr');
    if (row) choose(Number(row.dataset.row));
  });

  /** Find the rows that pass all filters, in the order of the data. */
  function passing() {
    const words = parts.search.value.trim().toLowerCase();
    const chosen = filters.filter(({ select }) => select.value !== '');
    const set = chosen.map(({ key, select }) => [key.of, Number(select.value)]);
    return data.walks.map((_, row) => row).filter((row) => set.every(([of, value]) => of[row] === value)
      && (!words || data.nameOf(row).toLowerCase().includes(words)));
  }

  function valueOf(row, column) {
    if (column === 0) return data.nameOf(row);
    return column === 1 ? data.off(state.metric, row) : data.value(state.metric, column - FIRST_COLUMNS, row);
  }

  /** Filter and sort all rows, and show the first page of them. */
  function refresh() {
    const rows = passing();
    const keyed = rows.map((row) => [valueOf(row, state.column), row]);
    keyed.sort((a, b) => compareValues(a[0], b[0], state.direction) || a[1] - b[1]);
    state.order = keyed.map(([, row]) => row);
    state.page = 0;
    showHead();
    showRows();
  }

  function sortBy(column) {
    const first = column === 0 ? 1 : -1;  // words from A on, numbers from the largest on
    state.direction = state.column === column ? -state.direction : first;
    state.column = column;
    refresh();
  }

  function showHead() {
    const { name, unit, text, ideal } = data.metric(state.metric);
    const titles = ['walk', 'off by, mean', ...data.variants.map((one, i) => one.name + data.mark(name, i))];
    const headings = titles.map(
      (title, i) => makeElement('th', { className: i ? 'right' : '', scope: 'col' }, title),
    );
    const averages = data.variants.map((_, variant) => data.average(name, variant, state.order));
    const best = data.best(name, averages.map(({ mean }) => mean));
    const rows = [['mean', 'mean'], ['median', 'median'], ['90 %', 'p90']].map(([title, part]) => {
      const cells = averages.map((one, i) => valueCell(one[part], part === 'mean' && i === best));
      const heading = makeElement('th', { scope: 'row' }, title);
      return makeElement('tr', { className: 'average' }, heading, makeElement('td'), ...cells);
    });
    head.replaceChildren(makeElement('tr', {}, ...headings), ...rows);
    headings.forEach((heading, column) => makeSortButton(heading, () => {
      sortBy(column);
      head.rows[0].cells[column].firstChild.focus();
    }));
    markSorted(headings, state.column, state.direction);
    const aim = ideal === null ? '' : ` Ideal:\u00a0${ideal}${unit ? `\u00a0${unit}` : ''}.`;
    parts.meaning.textContent = `${text}${aim}`;
    if (parts.aligned) parts.aligned.hidden = data.variants.every((_, i) => !data.mark(name, i));
    const whole = data.walks.length;
    const shown = state.order.length;
    parts.count.textContent = shown === whole ? `All ${whole} tracks` : `${shown} of ${whole} tracks`;
    parts.reset.disabled = shown === whole;
  }

  function showRows() {
    const size = Number(parts.rows.value);
    const pages = Math.max(Math.ceil(state.order.length / size), 1);
    state.page = Math.min(state.page, pages - 1);
    const rows = state.order.slice(state.page * size, (state.page + 1) * size);
    body.replaceChildren(...rows.map(tableRow));
    showPages(parts.pages, state.page, pages, (page) => { state.page = page; showRows(); });
  }

  function tableRow(row) {
    const values = data.variants.map((_, variant) => data.value(state.metric, variant, row));
    const best = data.best(state.metric, values);
    const button = makeElement('button', { type: 'button', className: 'walk' }, data.nameOf(row));
    const name = makeElement('th', { scope: 'row' }, button);
    const cells = values.map((value, i) => valueCell(value, i === best));
    const properties = { 'data-row': row, 'aria-current': String(row === state.chosen) };
    return makeElement('tr', properties, name, valueCell(data.off(state.metric, row)), ...cells);
  }

  function choose(row) {
    state.chosen = row;
    for (const one of body.rows) one.setAttribute('aria-current', String(Number(one.dataset.row) === row));
    onChoose(row, state.metric);
  }

  function chooseAgain() {
    refresh();
    if (state.chosen >= 0) onChoose(state.chosen, state.metric);
  }

  /** Choose the row that comes some places after the chosen one, and turn to its page. */
  function step(by) {
    const place = Math.min(Math.max(state.order.indexOf(state.chosen) + by, 0), state.order.length - 1);
    if (place < 0) return;
    const page = Math.floor(place / Number(parts.rows.value));
    state.chosen = state.order[place];
    if (page !== state.page) { state.page = page; showRows(); }
    choose(state.chosen);
  }

  refresh();
  return { choose, step, order: () => state.order };
}

/** Create the cell of a value, which is emphasised if it is the best one. */
function valueCell(value, best = false, mark = '') {
  const text = formatNumber(value) + (value === null ? '' : mark);
  return makeElement('td', { className: 'right' }, best ? makeElement('strong', {}, text) : text);
}

/** Add a select that filters walks by a key. */
function addFilter(place, key) {
  const select = makeElement('select', { 'data-key': key.name });
  fillSelect(select, [['', 'all'], ...key.values.map((value, i) => [i, value])]);
  place.append(makeElement('label', {}, key.name, select));
  return select;
}

/** Show which page of a table is shown, with buttons to the others; nothing for a single one. */
function showPages(place, page, pages, turnTo) {
  const button = (text, words, to) => {
    const disabled = to < 0 || to >= pages;
    const made = makeElement('button', { type: 'button', 'aria-label': words, disabled }, text);
    made.addEventListener('click', () => turnTo(to));
    return made;
  };
  place.replaceChildren(...(pages < 2 ? [] : [button('‹', 'page before', page - 1),
    `page ${page + 1} of ${pages}`, button('›', 'next page', page + 1)]));
}
