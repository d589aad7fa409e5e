import { Box3, Frustum, Matrix4, Quaternion, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from 'three';

import { PoseFlag } from '../live/pose_frame';
import type { PoseTable } from '../live/pose_table';
import { Backdrop } from './backdrop';
import { boundsOf, CameraRig } from './camera_rig';
import { Dress } from './dress';
import { MovingScene } from './moving_scene';
import { nodeRadii } from './node_radii';
import { OwnerColours, type Colouring } from './owner_colours';
import { Ride } from './ride';
import { RigidFrames } from './rigid_frames';
import type { SceneFile, SceneNode, Viewpoint } from './scene_file';

// The picture of one scene file, with poses for what moves. A new scene file replaces all but the camera.
export interface Overlay {
  update(view: SceneView, time_s: number): void;
}

interface Shown {
  readonly file: SceneFile;
  readonly moving: MovingScene;
  readonly ghosts: MovingScene;
  readonly frames: RigidFrames;
  readonly ghostFrames: RigidFrames;
  readonly colours: OwnerColours;
  readonly ghostColours: Float32Array;
  readonly radii_m: Float64Array;
}

export class SceneView {
  readonly scene = new Scene();
  readonly rig: CameraRig;
  readonly overlays: Overlay[] = [];
  showsGhosts = false;
  selected: number | null = null;
  instancesDrawn = 0;
  private readonly renderer: WebGLRenderer;
  private readonly backdrop: Backdrop;
  private readonly dress = new Dress();
  private readonly ride = new Ride();
  private readonly frustum = new Frustum();
  private readonly viewProjection = new Matrix4();
  private shown: Shown | null = null;
  private colouring_: Colouring = 'world';
  private pageColour = '#ffffff';

  constructor(private readonly surface: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas: surface, antialias: true, powerPreference: 'high-performance' });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.scene.matrixAutoUpdate = false;
    this.rig = new CameraRig(surface);
    this.backdrop = new Backdrop(this.scene, this.rig.camera);
  }

  get file(): SceneFile | null {
    return this.shown?.file ?? null;
  }
  get frames(): RigidFrames | null {
    return this.shown?.frames ?? null;
  }
  get ghostFrames(): RigidFrames | null {
    return this.shown?.ghostFrames ?? null;
  }
  get drawCalls(): number {
    return this.renderer.info.render.calls;
  }

  set colouring(colouring: Colouring) {
    this.colouring_ = colouring;
    this.shown?.moving.dress((own) => this.dress.materialFor(own, colouring));
  }

  show(file: SceneFile): void {
    const first = this.shown === null;
    if (this.shown !== null) this.clear(this.shown);
    const moving = new MovingScene(file.shapes, (own) => this.dress.materialFor(own, this.colouring_));
    const ghosts = new MovingScene(file.shapes, (own) => this.dress.ghostMaterialFor(own));
    this.scene.add(file.standing, moving.group, ghosts.group, ...file.carried.map(({ object }) => object));
    this.ride.end();
    this.shown = {
      file,
      moving,
      ghosts,
      frames: new RigidFrames(file.nodeCount),
      ghostFrames: new RigidFrames(file.nodeCount),
      colours: new OwnerColours(file.nodeCount),
      ghostColours: new Float32Array(file.nodeCount * 3).fill(1),
      radii_m: nodeRadii(file),
    };
    this.shown.frames.placeAsFiled(file.nodes);
    this.backdrop.show(file.extras, file.hasLights, this.pageColour);
    if (first) this.firstLook(file);
    else this.rig.measure(this.bounds());
  }

  // The viewpoint of a moving node is where the node is now, and goes with it.
  visit(viewpoint: Viewpoint): void {
    const { node } = viewpoint;
    this.ride.end();
    const frames = this.shown?.frames;
    if (node === undefined || frames === undefined || frames.known[node] === 0) {
      this.rig.visit(viewpoint);
      return;
    }
    const motion = frames.matrix(node, new Matrix4());
    const turn = new Quaternion(...viewpoint.orientation_xyzw).premultiply(new Quaternion().setFromRotationMatrix(motion));
    const place = new Vector3(...viewpoint.position_m).applyMatrix4(motion);
    this.rig.visit({ ...viewpoint, position_m: place.toArray(), orientation_xyzw: [turn.x, turn.y, turn.z, turn.w] });
    this.ride.begin(node, frames);
  }

  fit(): void {
    this.ride.end();
    this.rig.fit(this.bounds());
  }

  setPageColour(colour: string): void {
    this.pageColour = colour;
    this.backdrop.setPageColour(colour);
  }

  resize(width: number, height: number): void {
    this.renderer.setSize(width, height, false);
    this.rig.resize(width, height);
  }

  render(): void {
    this.renderer.render(this.scene, this.rig.camera);
  }

  // Our own share of a picture of the poses at time_s: camera, poses, culling, overlays.
  place(poses: PoseTable, ghosts: PoseTable, time_s: number, elapsed_s: number): void {
    this.rig.update(elapsed_s);
    this.backdrop.follow();
    if (this.shown === null) return;
    const { file, moving, frames, colours } = this.shown;
    const camera = this.rig.camera;
    this.frustum.setFromProjectionMatrix(this.viewProjection.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    frames.update(file.nodes, poses, time_s);
    colours.update(file.nodes, poses, this.colouring_, this.selected);
    this.instancesDrawn = moving.update(frames, this.frustum, colours.rgb);
    this.placeGhosts(this.shown, poses, ghosts, time_s);
    for (const { node, object } of file.carried) {
      frames.matrix(node, object.matrix);
      object.matrixWorldNeedsUpdate = true;
    }
    this.ride.update(frames, this.rig);
    for (const overlay of this.overlays) overlay.update(this, time_s);
  }

  bounds(): Box3 {
    if (this.shown === null) return new Box3();
    const box = boundsOf([this.shown.file.standing]);
    const point = new Vector3();
    for (const node of this.shown.file.nodes) {
      const radius_m = this.radiusOf(node);
      point.set(node.pose[0], node.pose[1], node.pose[2]);
      box.expandByPoint(point.clone().addScalar(radius_m)).expandByPoint(point.addScalar(-radius_m));
    }
    return box;
  }

  // Around the shapes that stand at or below a path.
  standingBox(path: string): Box3 {
    const box = new Box3();
    this.shown?.file.standing.traverse((part) => {
      const at = (part.userData as { path?: string }).path;
      if (at === path || at?.startsWith(`${path}/`) === true) box.expandByObject(part);
    });
    return box;
  }

  radiusOf(node: SceneNode): number {
    return this.shown?.radii_m[node.index] ?? 0;
  }

  // The ray through a place of the window [px].
  ray(x: number, y: number): { origin: Vector3; direction: Vector3 } {
    const { origin, direction } = this.casterAt(x, y).ray;
    return { origin, direction };
  }

  // The moving node that is drawn at a place of the window; null where there is none.
  nodeUnder(x: number, y: number): number | null {
    const caster = this.casterAt(x, y);
    let nearest = { distance: Infinity, node: -1 };
    for (const batch of this.shown?.moving.batches ?? []) {
      batch.mesh.boundingSphere = null; // its instances have moved since it was computed
      for (const hit of caster.intersectObject(batch.mesh, false)) {
        if (hit.distance < nearest.distance) nearest = { distance: hit.distance, node: batch.nodeAt(hit.instanceId ?? 0) };
      }
    }
    return nearest.node < 0 ? null : nearest.node;
  }

  // Where a point of the world is on the window [px]; null behind the camera.
  onWindow(point: Vector3): { x: number; y: number } | null {
    const box = this.surface.getBoundingClientRect();
    const p = point.clone().project(this.rig.camera);
    return p.z > 1 ? null : { x: box.left + ((p.x + 1) / 2) * box.width, y: box.top + ((1 - p.y) / 2) * box.height };
  }

  private casterAt(x: number, y: number): Raycaster {
    const box = this.surface.getBoundingClientRect();
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2), this.rig.camera);
    return caster;
  }

  // Beside own objects only: what is shown of other peers' objects is their ghost.
  private placeGhosts(shown: Shown, poses: PoseTable, ghosts: PoseTable, time_s: number): void {
    shown.ghosts.group.visible = this.showsGhosts;
    if (!this.showsGhosts) return;
    shown.ghostFrames.update(shown.file.nodes, ghosts, time_s, poses, PoseFlag.own);
    shown.ghosts.update(shown.ghostFrames, this.frustum, shown.ghostColours);
  }

  private firstLook(file: SceneFile): void {
    const viewpoint = file.extras.viewpoints?.[0];
    this.rig.measure(this.bounds());
    if (viewpoint !== undefined) this.visit(viewpoint);
    else this.fit();
  }

  private clear(shown: Shown): void {
    shown.file.standing.removeFromParent();
    for (const { object } of shown.file.carried) object.removeFromParent();
    shown.moving.dispose();
    shown.ghosts.dispose();
    for (const shape of shown.file.shapes) shape.geometry.dispose();
  }
}
