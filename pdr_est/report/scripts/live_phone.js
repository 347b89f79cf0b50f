/** Send the motion sensors of this phone while the page is open. */
'use strict';

const SEND_EVERY_MS = 20;
const ROWS_AT_ONCE = 500;
const MOST_ROWS = 12000;  // two minutes at 100 Hz without a connection
const ORIENTATION_PATIENCE_MS = 1000;

/**
 * Create the sender.
 *
 * @param link  connection by createLink
 * @param onState  called with words that say what happens
 * @returns start(): asks for the sensors, which browsers allow only after a press; reconnect(): call when connected;
 *     stop(words): sends no more
 */
function createPhone(link, onState) {
  const identity = crypto.randomUUID ? crypto.randomUUID() : String(Math.random());
  const isTouchedMac = /Mac/.test(navigator.userAgent) && navigator.maxTouchPoints > 1;  // an iPad says so
  const isIos = /iPad|iPhone|iPod/.test(navigator.userAgent) || isTouchedMac;
  let rows = [];
  let up = null;
  let started_ms = NaN;
  let heard = false;
  let timer = 0;

  async function start() {
    if (typeof DeviceMotionEvent === 'undefined') { onState('This browser knows no motion sensors.'); return; }
    if (!window.isSecureContext) { onState('Motion sensors need the https address.'); return; }
    try {
      for (const kind of [DeviceMotionEvent, window.DeviceOrientationEvent]) {
        const answer = kind && kind.requestPermission ? await kind.requestPermission() : 'granted';
        if (answer !== 'granted') throw new Error('refused');
      }
    } catch (error) {
      onState('The sensors were not allowed: load the page again and allow them.');
      return;
    }
    window.addEventListener('devicemotion', takeMotion);
    window.addEventListener('deviceorientation', takeOrientation);
    started_ms = performance.now();
    timer = setInterval(send, SEND_EVERY_MS);
    setTimeout(() => { if (!heard && timer) onState('No motion sensor answers here.'); }, 3000);
    keepAwake();
    document.addEventListener('visibilitychange', keepAwake);
    reconnect();
    onState('Sending. Keep this page open and the screen on.');
  }

  function reconnect() {
    if (Number.isFinite(started_ms)) link.send({ type: 'phone', id: identity });
  }

  function stop(words) {
    window.removeEventListener('devicemotion', takeMotion);
    window.removeEventListener('deviceorientation', takeOrientation);
    document.removeEventListener('visibilitychange', keepAwake);
    clearInterval(timer);
    timer = 0;
    started_ms = NaN;
    rows = [];
    onState(words);
  }

  async function keepAwake() {
    try {
      if (navigator.wakeLock && document.visibilityState === 'visible') await navigator.wakeLock.request('screen');
    } catch (error) {
      onState('Sending. Keep the screen on: this browser cannot.');
    }
  }

  function takeOrientation(event) {
    if (event.beta === null || event.gamma === null) return;
    const beta = (event.beta * Math.PI) / 180;
    const gamma = (event.gamma * Math.PI) / 180;
    up = [-Math.cos(beta) * Math.sin(gamma), Math.sin(beta), Math.cos(beta) * Math.cos(gamma)];
  }

  function takeMotion(event) {
    const now_ms = performance.now();
    const at_ms = Math.abs(now_ms - event.timeStamp) < 1000 ? event.timeStamp : now_ms;
    const time_s = link.now_s(at_ms);
    const force = event.accelerationIncludingGravity || {};
    const rate = event.rotationRate || {};
    if (!Number.isFinite(time_s)) return;
    heard = heard || Number.isFinite(force.x);
    const row = [time_s, force.x, force.y, force.z, rate.alpha, rate.beta, rate.gamma];
    rows.push(row.map((value) => (Number.isFinite(value) ? value : null)));
    if (rows.length > MOST_ROWS) rows = rows.slice(-MOST_ROWS);
  }

  function send() {
    const settled = up !== null || performance.now() - started_ms > ORIENTATION_PATIENCE_MS;
    while (rows.length && settled && link.isOpen()) {
      link.send({ type: 'motion', rows: rows.slice(0, ROWS_AT_ONCE), up, ios: isIos });
      rows = rows.slice(ROWS_AT_ONCE);
    }
  }

  return { start, reconnect, stop };
}
