// Pixels of a canvas per CSS pixel. At least two, so that charts are sharp in print and in saved pictures;
// build.mjs puts this in place of the browser's number, for uPlot too.
export const devicePixelRatio = Math.max(2, window.devicePixelRatio || 1);
