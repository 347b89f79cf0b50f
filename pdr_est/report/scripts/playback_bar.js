/** Make the controls of the time cursor: playback with its speed, a slider, and the time window of the charts. */
'use strict';

/** Fill an element with a play button, a slider over the whole walk, the time and the speed. */
function fillPlaybackBar(element, cursor) {
  const button = makeElement('button', { type: 'button', className: 'play' });
  const range = { min: cursor.begin_s, max: cursor.end_s, step: 0.1 };
  const slider = makeElement('input', { type: 'range', ...range, className: 'time-slider' });
  slider.setAttribute('aria-label', 'Time');
  const time = makeElement('output', { className: 'time-now' });
  const speeds = [1, 4, 16, 60].map((times) => makeElement('option', { value: times }, `${times}×`));
  const speed = makeElement('select', {}, ...speeds);
  speed.setAttribute('aria-label', 'Speed of the playback');
  speed.value = cursor.end_s - cursor.begin_s > 600 ? '60' : '4';
  const show = () => { slider.value = cursor.time_s; time.textContent = timeText(cursor.time_s - cursor.begin_s); };
  const showPlaying = () => {
    button.textContent = cursor.playing ? '❚❚' : '▶';
    button.setAttribute('aria-label', cursor.playing ? 'Pause' : 'Play');
  };
  slider.addEventListener('input', () => { cursor.pause(); cursor.setTime(Number(slider.value)); });
  button.addEventListener('click', () => (cursor.playing ? cursor.pause() : cursor.play(Number(speed.value))));
  speed.addEventListener('change', () => { if (cursor.playing) cursor.play(Number(speed.value)); });
  cursor.onTime(show);
  cursor.onPlaying(showPlaying);
  show();
  showPlaying();
  element.append(button, slider, time, speed);
}

/** Fill an element with buttons that choose the time window of the charts. */
function fillWindowBar(element, cursor) {
  const add = (words, label, act) => {
    const button = makeElement('button', { type: 'button', title: label }, words);
    button.setAttribute('aria-label', label);
    button.addEventListener('click', act);
    element.append(button);
    return button;
  };
  const whole_s = cursor.end_s - cursor.begin_s;
  const spans = [[10, '10 s'], [60, '1 min'], [600, '10 min']].filter(([span_s]) => span_s < whole_s);
  const buttons = spans.map(([span_s, words]) => (
    [span_s, add(words, `Show ${words} about the cursor`, () => cursor.zoomTo(span_s))]));
  buttons.push([whole_s, add('whole', 'Show the whole walk', () => cursor.setWindow(cursor.begin_s, cursor.end_s))]);
  add('◂', 'Earlier', () => cursor.move(-0.5));
  add('▸', 'Later', () => cursor.move(0.5));
  const mark = () => {
    const span_s = cursor.window[1] - cursor.window[0];
    for (const [own_s, button] of buttons) {
      button.setAttribute('aria-pressed', String(Math.abs(own_s - span_s) < 1e-3));
    }
  };
  cursor.onWindow(mark);
  mark();
}
