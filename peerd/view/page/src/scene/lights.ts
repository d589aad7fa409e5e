import { Light, PointLight, SpotLight, type Object3D } from 'three';

// VRML's lights do not fade with the square of the distance, as glTF's do: by default they do not fade at all within their
// radius. The file says what VRML has (extras of its light nodes), and the lights are set by it. Attenuation is drawn by its
// highest power alone.
export interface LightExtras {
  readonly light?: {
    readonly attenuation?: readonly [number, number, number];
    readonly radius_m?: number;
    readonly on?: boolean; // as the file has it
    readonly driven_on?: number; // which look it is
    readonly driven_color?: number;
    readonly driven_intensity?: number;
    fades?: number; // what attenuation divides the intensity by
  };
}

export const kFullLight = Math.PI; // a white surface is white: it divides by that

export function setLights(root: Object3D): number {
  let count = 0;
  root.traverse((part) => {
    if (!(part instanceof Light)) return;
    ++count;
    if (extrasOf(part).on === false) part.visible = false;
    if (part instanceof PointLight || part instanceof SpotLight) fade(part);
  });
  return count;
}

export function extrasOf(light: Light): NonNullable<LightExtras['light']> {
  return (light.userData as LightExtras).light ?? (light.parent?.userData as LightExtras | undefined)?.light ?? {};
}

function fade(light: PointLight | SpotLight): void {
  const extras = extrasOf(light);
  const [constant, linear, square] = extras.attenuation ?? [1, 0, 0];
  light.decay = square > 0 ? 2 : linear > 0 ? 1 : 0;
  extras.fades = Math.max(square > 0 ? square : linear > 0 ? linear : constant, 1e-3);
  light.intensity /= extras.fades;
  light.distance = extras.radius_m ?? 0;
}
