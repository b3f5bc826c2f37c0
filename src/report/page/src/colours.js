// Colours of the page and of its series.

/// A colour of the style sheet, as it is now: it changes with the reader's dark mode.
export const pageColour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export const inkOf = () => pageColour("ink");

/// Colours that a series has by name: those of the style sheet.
const NAMED = { ink: "ink", faint: "line" };

/// For the canvas.
export const colourOf = ({ colour }) => (NAMED[colour] ? pageColour(NAMED[colour]) : colour);

/// For an element: it follows the style sheet by itself.
export const cssColourOf = ({ colour }) => (NAMED[colour] ? `var(--${NAMED[colour]})` : colour);
