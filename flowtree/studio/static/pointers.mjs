/**
 * Mouse, pen and fingers on the board: draw with the first button, pan with the second, third or Space, zoom with the
 * wheel; two fingers pan and zoom. Once a pen was there one finger pans, too: a hand that lies on the glass does not
 * draw. A pen's other end takes away.
 */

import { forceOf } from "flowtree-studio/pressure.mjs";

const ERASER = 5; // the button that a pen's other end counts as

/**
 * @param {HTMLCanvasElement} canvas
 * @param {object} board with begin, finish, cancel, pan, zoom, hover, drawInk; its `live` is set here
 * @returns {{panning: boolean, busy: boolean}} whether the next drag pans, and whether a gesture is under way
 */
export function watchPointers(canvas, board) {
  const status = { panning: false, busy: false };
  const fingers = new Map();
  let penned = false;
  let drag = null; // {id, kind: "draw" | "pan", at, finger}

  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.x, event.clientY - box.y];
  };
  const touch = (event) => [...place(event), forceOf(event)];

  const stop = (how) => {
    const { live } = board;
    status.busy = false;
    drag = null;
    if (live) board[how](live);
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    const at = place(event);
    const finger = event.pointerType === "touch";
    if (finger) fingers.set(event.pointerId, at);
    if (event.pointerType === "pen") {
      penned = true;
      if (drag?.finger) stop("cancel"); // it was the hand that holds the pen
    }
    if (fingers.size === 2) {
      stop("cancel");
      return;
    }
    if (drag) return; // a palm beside the pen
    const rubs = event.button === ERASER;
    if ((event.button !== 0 && !rubs) || status.panning || (finger && penned)) {
      drag = { id: event.pointerId, kind: "pan", at, finger };
      return;
    }
    board.live = board.begin(touch(event), rubs);
    status.busy = board.live !== null;
    drag = board.live ? { id: event.pointerId, kind: "draw", at, finger } : null;
    board.drawInk();
  });

  canvas.addEventListener("pointermove", (event) => {
    const at = place(event);
    if (fingers.size === 2 && fingers.has(event.pointerId)) {
      pinch(fingers, event.pointerId, at, board);
      return;
    }
    if (drag?.id === event.pointerId && drag.kind === "pan") {
      board.pan(at[0] - drag.at[0], at[1] - drag.at[1]);
      drag.at = at;
    } else if (drag?.id === event.pointerId) {
      const between = event.getCoalescedEvents?.() ?? [];
      board.live.move((between.length > 0 ? between : [event]).map(touch));
    }
    board.hover(event.pointerType === "touch" ? null : at);
  });

  const up = (how) => (event) => {
    fingers.delete(event.pointerId);
    if (drag?.id !== event.pointerId) return;
    if (drag.kind === "draw") stop(how);
    drag = null;
  };
  canvas.addEventListener("pointerup", up("finish"));
  canvas.addEventListener("pointercancel", up("cancel"));
  canvas.addEventListener("pointerleave", () => board.hover(null));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 30 : 1;
      board.zoom(Math.exp(-event.deltaY * lines * 0.0015), place(event));
    },
    { passive: false },
  );
  return status;
}

/** Two fingers: their middle moves the picture, their distance scales it. */
function pinch(fingers, id, at, board) {
  const [first, second] = [...fingers.values()];
  const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const apart = (a, b) => Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 1);
  const before = { at: middle(first, second), apart: apart(first, second) };
  fingers.set(id, at);
  const [a, b] = [...fingers.values()];
  const now = middle(a, b);
  board.pan(now[0] - before.at[0], now[1] - before.at[1]);
  board.zoom(apart(a, b) / before.apart, now);
}
