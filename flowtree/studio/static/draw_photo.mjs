/** One photo on the board: the picture, its matte in one of several ways, its attractor graph, its marks. */

import { seenEnds } from "flowtree-studio/arranging.mjs";
import { drawHandle, drawStrokes, drawWire } from "flowtree-studio/ink.mjs";

/** The marks of a photo: those given, else those that were found, in its pixels. */
export function marksOf(photo, camera) {
  const found = camera && seenEnds(camera);
  const marks = {};
  const foot = photo.marks.foot ?? found?.foot;
  const top = photo.marks.top ?? found?.top;
  if (foot) marks.foot = { at: foot, given: photo.marks.foot != null };
  if (top != null) {
    marks.top = { at: [foot ? foot[0] : photo.width / 2, top], given: photo.marks.top != null };
  }
  if (photo.marks.fork) marks.fork = { at: photo.marks.fork, given: true };
  else if (foot && top != null) marks.fork = { at: [foot[0], foot[1] + 0.3 * (top - foot[1])], given: false };
  return marks;
}

/** Foot and top to arrange a photo by, also before anything was found. */
export function arrangedMarks(photo, camera) {
  const { foot, top } = marksOf(photo, camera);
  return {
    foot: foot ? foot.at : [photo.width / 2, photo.height * 0.94],
    top: top ? top.at[1] : photo.height * 0.06,
  };
}

/**
 * Draws a photo; the context's units are its pixels.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {{photo: object, picture: any, matte: any, graph: any, camera: any}} what
 * @param {{mode: string, show: string, split: number, graphShown: boolean}} how
 * @param {number} pixel a screen pixel in photo pixels
 */
export function drawPhoto(context, { photo, picture, matte, graph, camera }, how, pixel) {
  const { width, height } = photo;
  context.imageSmoothingQuality = "high";
  const show = matte && how.mode !== "branches" ? how.show : "photo";
  if (show === "checker" || show === "split") {
    const from = show === "split" ? how.split * width : 0;
    context.drawImage(picture, 0, 0, width, height);
    context.save();
    context.beginPath();
    context.rect(from, 0, width - from, height);
    context.clip();
    drawChecker(context, from, width, height, pixel);
    context.drawImage(matte.cutout(picture), 0, 0, width, height);
    context.restore();
    if (show === "split") drawDivider(context, from, height, pixel);
  } else if (show === "grey") {
    context.drawImage(matte.as("grey"), 0, 0, width, height);
  } else {
    context.drawImage(picture, 0, 0, width, height);
    if (show === "overlay") context.drawImage(matte.as("overlay"), 0, 0, width, height);
  }
  if (how.mode === "branches") {
    context.fillStyle = "rgba(16, 20, 18, 0.35)";
    context.fillRect(0, 0, width, height);
    if (graph && how.graphShown) drawGraph(context, graph, pixel);
  }
  drawStrokes(context, photo, how.mode, pixel);
  if (how.mode === "branches") {
    for (const tip of photo.marks.seeds ?? []) drawMark(context, "tip", tip, pixel, true, width);
    const marks = marksOf(photo, camera);
    for (const [name, { at, given }] of Object.entries(marks)) {
      if (name !== "fork" || given || how.tool === "marks") drawMark(context, name, at, pixel, given, width);
    }
  }
}

function drawGraph(context, { lines, widths }, pixel) {
  lines.forEach((line, i) => {
    const width = Math.min(Math.max((widths?.[i] ?? 0) * 0.35, 1.6 * pixel), 7 * pixel);
    drawWire(context, line, "#ff5d7d", width);
  });
}

/** Foot, top, fork or tip, hollow while it is only found. */
export function drawMark(context, name, at, pixel, given, width, active = false) {
  const colors = { foot: "#ffd166", top: "#7fd1ff", fork: "#d3a4ff", tip: "#ffb454" };
  if (name === "foot" || name === "top") {
    context.save();
    context.setLineDash([6 * pixel, 5 * pixel]);
    context.strokeStyle = colors[name];
    context.globalAlpha = 0.7;
    context.lineWidth = 1.2 * pixel;
    context.beginPath();
    context.moveTo(0, at[1]);
    context.lineTo(width, at[1]);
    context.stroke();
    context.restore();
  }
  const text = { tip: "", fork: given ? "fork" : "fork, not set" }[name] ?? (given ? name : `${name}, found`);
  drawHandle(context, at, text, pixel, { color: colors[name], given, active });
}

function drawChecker(context, from, width, height, pixel) {
  const side = 12 * pixel;
  context.fillStyle = "#e9ebe8";
  context.fillRect(from, 0, width - from, height);
  context.fillStyle = "#cfd3cf";
  const first = Math.floor(from / side);
  for (let row = 0; row * side < height; row += 1) {
    for (let column = first + ((row + first) % 2); column * side < width; column += 2) {
      context.fillRect(column * side, row * side, side, Math.min(side, height - row * side));
    }
  }
}

function drawDivider(context, x, height, pixel) {
  context.fillStyle = "#fff";
  context.fillRect(x - pixel, 0, 2 * pixel, height);
  drawHandle(context, [x, height / 2], "", pixel, { active: true });
}
