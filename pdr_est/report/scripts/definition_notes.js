/** Explain metrics where they stand: a link to a definition opens a note with its text. */
'use strict';

const NOTE_EDGE_PX = 8;

/** Let every link to an element of the page's definitions, now or later, open a note beside it. */
function explainDefinitions() {
  const note = makeElement('div', { className: 'note', role: 'tooltip', id: 'definition-note', hidden: true });
  let shownFor = null;
  let pinned = false;
  document.body.append(note);

  function linkOf(target) {
    return target instanceof Element ? target.closest('a[href^="#define-"]') : null;
  }

  function open(link) {
    const term = document.getElementById(link.getAttribute('href').slice(1));
    if (!term) return;
    close();
    note.replaceChildren(makeElement('strong', {}, term.textContent), ' ', term.nextElementSibling.textContent);
    note.hidden = false;
    link.setAttribute('aria-describedby', note.id);
    shownFor = link;
    placeBelow(note, link);
  }

  function close() {
    if (shownFor) shownFor.removeAttribute('aria-describedby');
    note.hidden = true;
    shownFor = null;
    pinned = false;
  }

  document.addEventListener('click', (event) => {
    const link = linkOf(event.target);
    if (link) {
      event.preventDefault();
      const again = pinned && link === shownFor;
      if (again) { close(); return; }
      open(link);
      pinned = true;
    } else if (!note.contains(event.target)) close();
  });
  document.addEventListener('pointerover', (event) => {
    if (event.pointerType !== 'mouse' || pinned) return;
    const link = linkOf(event.target);
    if (link) open(link);
    else if (shownFor && !note.contains(event.target)) close();
  });
  document.addEventListener('keydown', (event) => { if (event.key === 'Escape') close(); });
  window.addEventListener('resize', close);
}

/** Place an element of the body below another one, within the width of the window. */
function placeBelow(element, anchor) {
  const at = anchor.getBoundingClientRect();
  const room = document.documentElement.clientWidth;
  element.style.left = '0';
  const left = Math.min(at.left, room - element.offsetWidth - NOTE_EDGE_PX);
  element.style.left = `${Math.max(left, NOTE_EDGE_PX) + window.scrollX}px`;
  element.style.top = `${at.bottom + window.scrollY + 4}px`;
}
