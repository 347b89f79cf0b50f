/** Sort tables of a page by a press on the heading of a column. */
'use strict';

/** Read the number that a cell begins with: minus signs and narrow spaces are those of the page. */
function leadingNumber(text) {
  const found = /^[+-]?\d+(\.\d+)?/.exec(text.replace(/−/g, '-').replace(/[\u202f\u00a0]/g, ''));
  return found ? parseFloat(found[0]) : null;
}

/** Compare two values for ascending or descending order (direction 1 or -1); missing ones come last in both. */
function compareValues(a, b, direction) {
  if (a === null || b === null) return (a === null) - (b === null);
  if (typeof a === 'number' && typeof b === 'number') return direction * (a - b);
  return direction * String(a).localeCompare(String(b), undefined, { numeric: true });
}

/** Put a button into a heading, which tells the order of its column. */
function makeSortButton(heading, onPress) {
  const button = makeElement('button', { type: 'button', className: 'sort' }, ...heading.childNodes);
  button.addEventListener('click', onPress);
  heading.replaceChildren(button);
  return button;
}

/** Tell which heading of a row the table is sorted by; direction 1: ascending, -1: descending. */
function markSorted(headings, column, direction) {
  headings.forEach((heading, place) => {
    if (place === column) heading.setAttribute('aria-sort', direction > 0 ? 'ascending' : 'descending');
    else heading.removeAttribute('aria-sort');
  });
}

/**
 * Make a table sortable.
 *
 * Rows of a table of class "blocks" belong together where their first cells are equal, because only numbers of one
 * metric compare: its first column sorts the blocks, each other column the rows within every block.
 */
function makeSortable(table) {
  const headings = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];
  const inBlocks = table.classList.contains('blocks');
  let sorted = { column: -1, direction: 1 };

  function valueOf(row, column) {
    const text = row.cells[column].textContent.trim();
    return row.cells[column].classList.contains('right') ? leadingNumber(text) : text;
  }

  function sortBy(column) {
    const direction = sorted.column === column ? -sorted.direction : 1;
    sorted = { column, direction };
    const compare = (a, b) => compareValues(valueOf(a, column), valueOf(b, column), direction);
    const blocks = blocksOf([...body.rows], inBlocks);
    if (inBlocks && column === 0) blocks.sort((a, b) => compare(a[0], b[0]));
    else blocks.forEach((block) => block.sort(compare));
    if (inBlocks) blocks.forEach((block) => block.forEach((row, i) => row.classList.toggle('first', i === 0)));
    body.append(...blocks.flat());
    markSorted(headings, column, direction);
  }

  headings.forEach((heading, column) => makeSortButton(heading, () => sortBy(column)));
}

/** Divide rows into runs of the same first cell, or leave them all in one. */
function blocksOf(rows, inBlocks) {
  const blocks = [];
  let last = null;
  for (const row of rows) {
    const key = inBlocks ? row.cells[0].textContent.trim() : '';
    if (key !== last) blocks.push([]);
    blocks[blocks.length - 1].push(row);
    last = key;
  }
  return blocks;
}
