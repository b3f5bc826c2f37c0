// Colours of the page and of its series.

/// A colour of the style sheet, as it is now: it changes with the reader's dark mode.
export const pageColour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export const inkOf = () => pageColour("ink");

/// A series has a colour "#rrggbb", or one of the style sheet by its name.
const isNamed = (colour) => !colour.startsWith("#");

/// For the canvas.
export const colourOf = ({ colour }) => (isNamed(colour) ? pageColour(colour) : colour);

/// For an element: it follows the style sheet by itself.
export const cssColourOf = ({ colour }) => (isNamed(colour) ? `var(--${colour})` : colour);
