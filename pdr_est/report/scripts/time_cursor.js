/** Keep the one time that map, plots and table show, the time window of the plots, and the playback. */
'use strict';

/** Create the answer of a map to the pointer: the time of a pose near it is shown; a press ends the playback. */
function timePicker(cursor) {
  return (time_s, device, index, pressed) => {
    if (pressed) cursor.pause();
    if (!cursor.playing) cursor.setTime(time_s);
  };
}

/**
 * Create the time cursor of a page.
 *
 * @returns time_s, window ([begin_s, end_s]), setTime, setWindow, zoomTo(span_s), move(share), play(speed), pause;
 *   onTime(call), onWindow(call) and onPlaying(call) register functions that are called when something has changed
 */
function createTimeCursor(begin_s, end_s) {
  const calls = { time: [], window: [], playing: [] };
  const tell = (what) => calls[what].forEach((call) => call(cursor));
  let frame = 0;
  const cursor = {
    begin_s, end_s, time_s: begin_s, window: [begin_s, end_s], playing: false,
    setTime, setWindow, zoomTo, move, play, pause,
    onTime: (call) => calls.time.push(call),
    onWindow: (call) => calls.window.push(call),
    onPlaying: (call) => calls.playing.push(call),
  };

  function setTime(time_s) {
    cursor.time_s = Math.min(Math.max(time_s, begin_s), end_s);
    tell('time');
  }

  function setWindow(from_s, to_s) {
    const span_s = Math.min(Math.max(to_s - from_s, 0.5), end_s - begin_s);
    const first_s = Math.min(Math.max(from_s, begin_s), end_s - span_s);
    if (Math.abs(first_s - cursor.window[0]) < 1e-6 && Math.abs(first_s + span_s - cursor.window[1]) < 1e-6) return;
    cursor.window = [first_s, first_s + span_s];
    tell('window');
  }

  /** Show a span about the cursor. */
  function zoomTo(span_s) {
    setWindow(cursor.time_s - span_s / 2, cursor.time_s + span_s / 2);
  }

  /** Move the window by a share of its length. */
  function move(share) {
    const by_s = share * (cursor.window[1] - cursor.window[0]);
    setWindow(cursor.window[0] + by_s, cursor.window[1] + by_s);
  }

  /** Make the window hold the cursor. */
  function follow() {
    const [from_s, to_s] = cursor.window;
    if (cursor.time_s >= from_s && cursor.time_s <= to_s) return;
    setWindow(cursor.time_s - 0.1 * (to_s - from_s), cursor.time_s + 0.9 * (to_s - from_s));
  }

  function play(speed) {
    pause();
    if (cursor.time_s >= end_s) setTime(begin_s);
    cursor.playing = true;
    tell('playing');
    let last_ms = null;
    const step = (now_ms) => {
      setTime(cursor.time_s + (last_ms === null ? 0 : (speed * (now_ms - last_ms)) / 1000));
      follow();
      last_ms = now_ms;
      if (cursor.time_s >= end_s) pause(); else frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
  }

  function pause() {
    cancelAnimationFrame(frame);
    if (!cursor.playing) return;
    cursor.playing = false;
    tell('playing');
  }

  return cursor;
}
