import { CanvasTexture, Color, DoubleSide, MeshBasicMaterial, MeshStandardMaterial, PlaneGeometry, SRGBColorSpace, type BufferGeometry, type Material } from 'three';

import { extentOf, fontOf, layOut, type TextExtras } from './text_layout';

// A Text as a rectangle whose texture a canvas has drawn, with a font of the browser's. Null: it has no extent.
export interface TextShape {
  readonly geometry: BufferGeometry;
  readonly material: Material;
}

const kPixelsPerSize = 64;
const kLongestSide_px = 2048;
const kMargin_px = 2; // so that the edge of a letter is not cut

export function textShape(text: TextExtras): TextShape | null {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d');
  if (context === null || !(text.size_m > 0)) return null;
  context.font = fontOf(text, kPixelsPerSize);
  const widthOf = (line: string): number => context.measureText(line).width / kPixelsPerSize;
  const placed = layOut(text, widthOf);
  const box = extentOf(placed, text.size_m, widthOf);
  const [width_m, height_m] = [box.right - box.left, box.top - box.bottom];
  if (!(width_m > 0) || !(height_m > 0)) return null;
  const perMetre_px = Math.min(kPixelsPerSize / text.size_m, (kLongestSide_px - 2 * kMargin_px) / Math.max(width_m, height_m));
  const margin_m = kMargin_px / perMetre_px;
  canvas.width = Math.ceil(width_m * perMetre_px) + 2 * kMargin_px;
  canvas.height = Math.ceil(height_m * perMetre_px) + 2 * kMargin_px;
  context.font = fontOf(text, perMetre_px * text.size_m);
  context.fillStyle = '#ffffff';
  for (const piece of placed) {
    context.setTransform(piece.stretch, 0, 0, 1, (piece.x - box.left) * perMetre_px + kMargin_px, (box.top - piece.y) * perMetre_px + kMargin_px);
    context.fillText(piece.text, 0, 0);
  }
  const geometry = new PlaneGeometry(canvas.width / perMetre_px, canvas.height / perMetre_px);
  geometry.translate(box.left - margin_m + canvas.width / perMetre_px / 2, box.top + margin_m - canvas.height / perMetre_px / 2, 0);
  return { geometry, material: materialOf(text, new CanvasTexture(canvas)) };
}

function materialOf(text: TextExtras, map: CanvasTexture): Material {
  map.colorSpace = SRGBColorSpace;
  const common = { color: new Color().setRGB(...text.color, SRGBColorSpace), map, transparent: true, opacity: 1 - text.transparency, alphaTest: 0.02, side: DoubleSide };
  const material = text.lit ? new MeshStandardMaterial({ ...common, emissive: new Color().setRGB(...text.emissive, SRGBColorSpace), roughness: 0.8, metalness: 0 }) : new MeshBasicMaterial(common);
  material.userData = { text: true, driven: text.driven };
  return material;
}
