import {
  AmbientLight,
  BackSide,
  BufferAttribute,
  Color,
  DirectionalLight,
  Fog,
  FogExp2,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  SphereGeometry,
  type Camera,
  type Scene,
} from 'three';

import type { SceneExtras } from './scene_file';

// What is behind and around the world: VRML's Background, Fog and headlight. A world without a Background has the page's
// own colour behind it, which follows the page's dark or light theme.
type Colour = readonly [number, number, number];

interface BackgroundFields {
  readonly sky_color?: readonly Colour[];
  readonly sky_angle?: readonly number[];
  readonly ground_color?: readonly Colour[];
  readonly ground_angle?: readonly number[];
}

interface FogFields {
  readonly color?: Colour;
  readonly type?: string;
  readonly visibility_range_m?: number;
}

const kSkyRings = 64; // 2.8 degrees a ring: bands of a gradient are not seen

export class Backdrop {
  private readonly headlight = new DirectionalLight(0xffffff, 1.6);
  private readonly sky: Mesh<SphereGeometry, MeshBasicMaterial>;
  private readonly fromAbove = new HemisphereLight(0xffffff, 0x8890a0, 1);
  private readonly everywhere = new AmbientLight(0xffffff, 0.25);
  private ownBackground = false;

  constructor(private readonly scene: Scene, private readonly camera: Camera) {
    this.sky = new Mesh(
      new SphereGeometry(1, 32, kSkyRings),
      new MeshBasicMaterial({ side: BackSide, vertexColors: true, depthTest: false, depthWrite: false, fog: false, toneMapped: false }),
    );
    this.sky.renderOrder = -1;
    this.sky.frustumCulled = false;
    this.sky.visible = false;
    // The headlight shines where the camera looks; the dim light from above keeps what it does not reach readable.
    camera.add(this.headlight, this.headlight.target);
    this.headlight.target.position.set(0, 0, -1);
    scene.add(camera, this.sky, this.fromAbove, this.everywhere);
  }

  // A world with lights of its own is lit by them; the light from above is only so much that shadows are not black.
  show(extras: SceneExtras, hasLights: boolean, pageColour: string): void {
    this.fromAbove.intensity = hasLights ? 0.45 : 0.9;
    this.headlight.intensity = hasLights ? 1 : 2;
    const background = extras.background as BackgroundFields | undefined;
    this.ownBackground = (background?.sky_color?.length ?? 0) > 0;
    this.sky.visible = this.ownBackground;
    if (background !== undefined && this.ownBackground) paintSky(this.sky.geometry, background);
    this.scene.fog = fogOf(extras.fog as FogFields | undefined);
    this.headlight.visible = extras.navigation?.headlight ?? true;
    this.setPageColour(pageColour);
  }

  setPageColour(colour: string): void {
    this.scene.background = this.ownBackground ? null : new Color(colour);
  }

  // The sky is infinitely far: it goes where the camera goes.
  follow(): void {
    this.sky.position.copy(this.camera.position);
    this.sky.scale.setScalar(10);
  }
}

function fogOf(fog: FogFields | undefined): Fog | FogExp2 | null {
  const range_m = fog?.visibility_range_m ?? 0;
  if (fog === undefined || range_m <= 0) return null;
  const [r, g, b] = fog.color ?? [1, 1, 1];
  const colour = new Color().setRGB(r, g, b, 'srgb');
  return fog.type === 'EXPONENTIAL' ? new FogExp2(colour.getHex(), 2 / range_m) : new Fog(colour.getHex(), 0, range_m);
}

// VRML's sky goes from the zenith (angle 0) down, its ground from the nadir up to the horizon and over the sky.
function paintSky(geometry: SphereGeometry, background: BackgroundFields): void {
  const places = geometry.getAttribute('position');
  const colours = new Float32Array(places.count * 3);
  const colour = new Color();
  const ground = background.ground_color ?? [];
  const lastGround = Math.max(...(background.ground_angle ?? []), 0);
  for (let i = 0; i < places.count; ++i) {
    const fromZenith = Math.acos(Math.min(1, Math.max(-1, places.getY(i))));
    const fromNadir = Math.PI - fromZenith;
    const onGround = ground.length > 0 && fromNadir <= lastGround;
    const [r, g, b] = onGround
      ? colourAt(fromNadir, ground, background.ground_angle ?? [])
      : colourAt(fromZenith, background.sky_color ?? [], background.sky_angle ?? []);
    colour.setRGB(r, g, b, 'srgb').toArray(colours, i * 3);
  }
  geometry.setAttribute('color', new BufferAttribute(colours, 3));
}

// The colour at an angle: colours[0] at 0, colours[i + 1] at angles[i], the last one from there on.
export function colourAt(angle: number, colours: readonly Colour[], angles: readonly number[]): Colour {
  let below = 0;
  for (let i = 0; i < angles.length && i + 1 < colours.length; ++i) {
    if (angle <= angles[i]) {
      const share = angles[i] > below ? (angle - below) / (angles[i] - below) : 1;
      const [a, b] = [colours[i], colours[i + 1]];
      return [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, a[2] + (b[2] - a[2]) * share];
    }
    below = angles[i];
  }
  return colours[Math.min(angles.length, colours.length - 1)] ?? [0, 0, 0];
}
