// Colours of the page and of its series.

/// A colour of the style sheet, as it is now: it changes with the reader's dark mode.
export const pageColour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export const inkOf = () => pageColour("ink");

/// For the canvas.
export const colourOf = (series) => (series.colour === "ink" ? inkOf() : series.colour);

/// For an element: it follows the style sheet by itself.
export const cssColourOf = (series) => (series.colour === "ink" ? "var(--ink)" : series.colour);
