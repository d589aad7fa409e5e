// Line icons of 20 by 20, drawn for this page.
const kPaths = {
  orbit: '<circle cx="10" cy="10" r="2.6"/><ellipse cx="10" cy="10" rx="8" ry="3.4" transform="rotate(-28 10 10)"/>',
  fly: '<path d="M3 10.5 17 4l-4.5 12.5-3-5z"/><path d="m9.5 11.500 3-3"/>',
  walk: '<circle cx="10.500" cy="3.600" r="1.700"/><path d="M10 7.200 8.700 12l2.800 2.200.7 3.300M8.700 12l-2.700 5M6 10.200l1.300-2.400 2.700-.6 2 2.600 2.400.9"/>',
  hand: '<path d="M6 11V6.2a1.2 1.2 0 0 1 2.4 0V9m0-4.200a1.200 1.200 0 0 1 2.400 0V9m0-3.200a1.200 1.200 0 0 1 2.400 0V9.500m0-1.500a1.200 1.200 0 0 1 2.300 0V12c0 3-2 5-4.700 5-2.300 0-3.600-.9-4.700-3l-2-3.400c-.4-.8.800-1.700 1.600-.9L6 11"/>',
  sun: '<circle cx="10" cy="10" r="3.400"/><path d="M10 2.500v1.800M10 15.700v1.800M2.500 10h1.800M15.700 10h1.800M4.700 4.700 6 6M14 14l1.300 1.300M4.700 15.300 6 14M14 6l1.300-1.300"/>',
  moon: '<path d="M16.500 11.800A7 7 0 0 1 8.200 3.500a7 7 0 1 0 8.300 8.300z"/>',
  help: '<circle cx="10" cy="10" r="7.500"/><path d="M7.900 7.900a2.200 2.200 0 1 1 3.200 2c-.8.400-1.100.9-1.100 1.700M10 14.200v.1"/>',
  play: '<path d="M6 4.200v11.600l9.500-5.800z"/>',
  pause: '<path d="M6.500 4.500v11M13.500 4.500v11"/>',
  undo: '<path d="M4 8.500h8a4 4 0 0 1 0 8H8M4 8.500 7.500 5M4 8.500 7.500 12"/>',
  redo: '<path d="M16 8.500H8a4 4 0 0 0 0 8h4M16 8.500 12.500 5M16 8.500 12.500 12"/>',
  layers: '<path d="m10 3 7 3.800-7 3.800-7-3.800z"/><path d="m3 10.300 7 3.800 7-3.800"/><path d="m3 13.600 7 3.400 7-3.400"/>',
  focus: '<circle cx="10" cy="10" r="2"/><path d="M3 7V4.500A1.500 1.500 0 0 1 4.500 3H7M13 3h2.500A1.500 1.500 0 0 1 17 4.500V7M17 13v2.500a1.500 1.500 0 0 1-1.500 1.500H13M7 17H4.500A1.500 1.500 0 0 1 3 15.500V13"/>',
  fit: '<path d="M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4"/>',
  lock: '<rect x="4.500" y="9" width="11" height="7.500" rx="1.500"/><path d="M7 9V6.500a3 3 0 0 1 6 0V9"/>',
  close: '<path d="m5 5 10 10M15 5 5 15"/>',
  keys: '<rect x="2.500" y="5.500" width="15" height="9.500" rx="1.500"/><path d="M5.500 8.500h.1M8.500 8.500h.1M11.500 8.500h.1M14.500 8.500h.1M6.500 12h7"/>',
} as const;

export type IconName = keyof typeof kPaths;

export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 20 20');
  svg.setAttribute('class', 'icon');
  svg.setAttribute('aria-hidden', 'true');
  svg.innerHTML = kPaths[name];
  return svg;
}
