// Where the lines of a VRML Text stand (ISO/IEC 14772-1, 6.20 and 6.47), in metres in the plane z = 0 of its Shape. What a
// browser's font knows, the widths of lines, comes as an argument.
export interface TextExtras {
  readonly lines: readonly string[];
  readonly family: readonly string[];
  readonly style: string;
  readonly justify: readonly string[];
  readonly length_m: readonly number[];
  readonly max_extent_m: number;
  readonly size_m: number;
  readonly spacing: number;
  readonly horizontal: boolean;
  readonly left_to_right: boolean;
  readonly top_to_bottom: boolean;
  readonly color: readonly [number, number, number];
  readonly emissive: readonly [number, number, number];
  readonly transparency: number;
  readonly lit: boolean;
  readonly driven?: Readonly<Record<string, number>>;
}

// A piece of text to draw: with its left end on the baseline at x, y, stretched by `stretch` along x.
export interface PlacedText {
  readonly text: string;
  readonly x: number;
  readonly y: number;
  readonly stretch: number;
}

const kAscent = 0.8; // of the size: from the baseline to the upper edge of a line
const kCell = 0.9; // of the size: from one character to the next of a vertical line

type Justify = 'FIRST' | 'BEGIN' | 'MIDDLE' | 'END';

function justifyOf(name: string | undefined, otherwise: Justify): Justify {
  return name === 'FIRST' || name === 'BEGIN' || name === 'MIDDLE' || name === 'END' ? name : otherwise;
}

// `widthOf`: of a line drawn with a size of 1 m.
export function layOut(text: TextExtras, widthOf: (line: string) => number): PlacedText[] {
  return text.horizontal ? horizontally(text, widthOf) : vertically(text, widthOf);
}

function horizontally(text: TextExtras, widthOf: (line: string) => number): PlacedText[] {
  const { lines, size_m: size, spacing } = text;
  const widths = stretched(text, lines.map((line) => widthOf(line) * size));
  const major = justifyOf(text.justify[0], 'BEGIN');
  const step = size * spacing * (text.top_to_bottom ? -1 : 1);
  const first = minorOffset(text, lines.length, size);
  return lines.map((line, i) => {
    const natural = widthOf(line) * size;
    return { text: line, x: majorOffset(major, widths[i], text.left_to_right), y: first + i * step, stretch: natural > 0 ? widths[i] / natural : 1 };
  });
}

// The lowest baseline, or the upper edge, of the block of lines by the minor justification.
function minorOffset(text: TextExtras, count: number, size: number): number {
  const minor = justifyOf(text.justify[1], 'FIRST');
  if (minor === 'FIRST') return 0;
  const reach = (count - 1) * size * text.spacing;
  const down = text.top_to_bottom;
  // The block reaches from `top` down to `bottom`, with the first baseline at 0.
  const top = (down ? 0 : reach) + kAscent * size;
  const bottom = (down ? -reach : 0) - (1 - kAscent) * size;
  if (minor === 'MIDDLE') return -(top + bottom) / 2;
  const beginsAtTop = minor === 'BEGIN' ? down : !down;
  return beginsAtTop ? -top : -bottom;
}

function majorOffset(major: Justify, width: number, forwards: boolean): number {
  if (major === 'MIDDLE') return -width / 2;
  return (major === 'END') === forwards ? -width : 0;
}

// `length` stretches single lines; then `maxExtent` narrows all of them where the longest is longer.
function stretched(text: TextExtras, natural: readonly number[]): number[] {
  const lengths = natural.map((width, i) => ((text.length_m[i] ?? 0) > 0 ? text.length_m[i] : width));
  const longest = Math.max(...lengths, 0);
  const share = text.max_extent_m > 0 && longest > text.max_extent_m ? text.max_extent_m / longest : 1;
  return lengths.map((length) => length * share);
}

// Characters stand upright below each other; lines go on to the right, or to the left.
function vertically(text: TextExtras, widthOf: (line: string) => number): PlacedText[] {
  const { lines, size_m: size, spacing } = text;
  const characters = lines.map((line) => [...line]);
  const heights = stretched(text, characters.map((line) => line.length * kCell * size));
  const major = justifyOf(text.justify[0], 'BEGIN');
  const minor = justifyOf(text.justify[1], 'FIRST');
  const step = size * spacing * (text.left_to_right ? 1 : -1);
  const reach = (lines.length - 1) * step + (text.left_to_right ? size : -size);
  const across = minor === 'MIDDLE' ? -reach / 2 : minor === 'END' ? -reach : 0;
  const placed: PlacedText[] = [];
  characters.forEach((line, i) => {
    const cell = line.length > 0 ? heights[i] / line.length : 0;
    const down = text.top_to_bottom;
    const begin = major === 'MIDDLE' ? heights[i] / 2 : (major === 'END') === down ? heights[i] : 0; // the upper edge
    line.forEach((character, k) => {
      const row = down ? k : line.length - 1 - k;
      const middle = across + i * step + (text.left_to_right ? size / 2 : -size / 2);
      placed.push({ text: character, x: middle - (widthOf(character) * size) / 2, y: begin - row * cell - kAscent * size, stretch: 1 });
    });
  });
  return placed;
}

export interface Extent {
  readonly left: number;
  readonly right: number;
  readonly bottom: number;
  readonly top: number;
}

export function extentOf(placed: readonly PlacedText[], size: number, widthOf: (line: string) => number): Extent {
  const out = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
  for (const { text, x, y, stretch } of placed) {
    out.left = Math.min(out.left, x);
    out.right = Math.max(out.right, x + widthOf(text) * size * stretch);
    out.bottom = Math.min(out.bottom, y - (1 - kAscent) * size);
    out.top = Math.max(out.top, y + kAscent * size);
  }
  return out;
}

const kFamilies: Readonly<Record<string, string>> = { SERIF: 'serif', SANS: 'sans-serif', TYPEWRITER: 'monospace' };

// A font of the browser's, as a canvas wants it: the first of the families that the standard names, else a serif one.
export function fontOf(text: Pick<TextExtras, 'family' | 'style'>, size_px: number): string {
  const family = text.family.map((name) => kFamilies[name]).find((known) => known !== undefined) ?? 'serif';
  const bold = text.style.startsWith('BOLD') ? 'bold ' : '';
  const italic = text.style.endsWith('ITALIC') ? 'italic ' : '';
  return `${italic}${bold}${size_px}px ${family}`;
}
