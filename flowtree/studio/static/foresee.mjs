/** What a command will make of a photo, shown until the project says so itself: the next stroke starts from there. */

const ADDED = { AddScribble: "scribbles", AddStroke: "strokes", AddPaint: "paint" };
const REMOVED = { RemoveScribbles: "scribbles", RemoveStrokes: "strokes", RemovePaint: "paint" };

/**
 * @param {object[]} photos as the project's state describes them; the one that the command is about is changed
 * @param {object} command as it travels
 */
export function foresee(photos, command) {
  const photo = photos[command.photo];
  if (!photo) return;
  const added = ADDED[command.command];
  const removed = REMOVED[command.command];
  if (added) photo[added] = [...photo[added], command];
  else if (removed) photo[removed] = photo[removed].filter((_, i) => !command.indices.includes(i));
  else if (command.command === "SetSeeds") photo.marks.seeds = command.points;
  else if (command.command === "SetMark") photo.marks[command.name] = command.value;
  else if (command.command === "PlacePhoto") Object.assign(photo.marks, { foot: command.foot, top: command.top });
  else if (command.command === "SetYaw") photo.yaw = command.yaw;
}
