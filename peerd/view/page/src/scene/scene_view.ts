import { Box3, Frustum, Matrix4, Mesh, Quaternion, Raycaster, Scene, Vector2, Vector3, WebGLRenderer, type Object3D } from 'three';
import { type LookRecord, PoseFlag, type PoseTable } from 'peerd';

import { Backdrop } from './backdrop';
import { boundsOf, CameraRig } from './camera_rig';
import { Dress } from './dress';
import { previewAt, type Preview } from './instance_batch';
import { Looks } from './looks';
import { MovingScene } from './moving_scene';
import { Occlusion, type OcclusionFigures } from './occlusion';
import { nodeRadii } from './node_radii';
import { OwnerColours, type Colouring } from './owner_colours';
import { Ride } from './ride';
import { RigidFrames } from './rigid_frames';
import type { MovingShape, SceneFile, SceneNode, Viewpoint } from './scene_file';
import { ViewGroups } from './view_groups';

// The picture of one scene file, with poses for what moves. A new scene file replaces all but the camera.
export interface Overlay {
  update(view: SceneView, time_s: number): void;
}

// A browser without WebGL, or whose graphics driver it does not trust, has no renderer.
function rendererOn(surface: HTMLCanvasElement): [WebGLRenderer, null] | [null, string] {
  try {
    const renderer = new WebGLRenderer({ canvas: surface, antialias: true, powerPreference: 'high-performance' });
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    return [renderer, null];
  } catch (error) {
    return [null, error instanceof Error ? error.message : String(error)];
  }
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
  readonly groups: ViewGroups;
  readonly looks: Looks;
  readonly occlusion: Occlusion | null; // without a picture nothing is hidden
}

export class SceneView {
  readonly scene = new Scene();
  readonly rig: CameraRig;
  readonly overlays: Overlay[] = [];
  showsGhosts = false;
  selected: number | null = null;
  eyeOf: string | null = null; // the path of the object from whose inside the camera looks, which is not drawn
  instancesDrawn = 0;
  drawCalls = 0;
  triangles = 0;
  private leavesOut = false;
  // Why there is no picture; null: there is one. All else goes on without it.
  readonly whyBlind: string | null;
  private readonly renderer: WebGLRenderer | null;
  private readonly backdrop: Backdrop;
  private readonly dress = new Dress();
  private readonly ride = new Ride();
  private readonly frustum = new Frustum();
  private readonly viewProjection = new Matrix4();
  private shown: Shown | null = null;
  private colouring_: Colouring = 'world';
  private pageColour = '#ffffff';

  constructor(private readonly surface: HTMLCanvasElement) {
    [this.renderer, this.whyBlind] = rendererOn(surface);
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
  // Whether what is hidden is left out of the picture.
  set leavesOutHidden(on: boolean) {
    if (this.leavesOut && !on) this.shown?.occlusion?.end();
    this.leavesOut = on;
  }
  get occlusion(): OcclusionFigures | null {
    return this.leavesOut ? (this.shown?.occlusion?.figures ?? null) : null;
  }

  set colouring(colouring: Colouring) {
    this.colouring_ = colouring;
    this.shown?.moving.dress((own) => this.dress.materialFor(own, colouring));
  }

  show(file: SceneFile): void {
    const first = this.shown === null;
    if (this.shown !== null) this.clear(this.shown);
    const moving = new MovingScene(file.shapes, (own) => this.dress.materialFor(own, this.colouring_), file.standingNode);
    const ghosts = new MovingScene(file.shapes.filter(({ material }) => (material.userData as { text?: boolean }).text !== true), (own) => this.dress.ghostMaterialFor(own));
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
      groups: new ViewGroups(file.extras.groups ?? []),
      looks: new Looks(file, [moving, ghosts]),
      occlusion: this.renderer && new Occlusion(this.renderer.getContext() as WebGL2RenderingContext, this.scene, file.standing, moving.batches),
    };
    this.shown.frames.stand(file.standingNode);
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

  takeLooks(records: readonly LookRecord[]): void {
    if (records.length > 0) this.shown?.looks.take(records);
  }

  setPageColour(colour: string): void {
    this.pageColour = colour;
    this.backdrop.setPageColour(colour);
  }

  resize(width: number, height: number): void {
    this.renderer?.setSize(width, height, false);
    this.rig.resize(width, height);
  }

  render(): void {
    const { renderer, rig, shown } = this;
    if (renderer === null) return;
    renderer.render(this.scene, rig.camera);
    const { queries, queryTriangles } = this.leavesOut && shown?.occlusion ? shown.occlusion.figures : { queries: 0, queryTriangles: 0 };
    this.drawCalls = renderer.info.render.calls - queries;
    this.triangles = renderer.info.render.triangles - queryTriangles;
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
    const eye = this.eyeOf === null ? undefined : file.byPath.get(this.eyeOf);
    if (eye !== undefined) frames.known[eye.index] = 0;
    colours.update(file.nodes, poses, this.colouring_, this.selected);
    this.shown.groups.update(frames, camera);
    if (this.leavesOut) this.shown.occlusion?.update(frames, this.frustum, this.viewProjection, camera, this.shown.groups);
    this.instancesDrawn = moving.update(frames, this.frustum, colours.rgb, this.shown.groups);
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
    for (const shape of this.shown.file.shapes) if (shape.node === this.shown.file.standingNode) expandByShape(box, shape);
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
    for (const shape of this.shown?.file.shapes ?? []) {
      if (shape.node !== this.shown?.file.standingNode) continue;
      if (shape.path === path || shape.path?.startsWith(`${path}/`) === true) expandByShape(box, shape);
    }
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
      if (batch.standing) continue;
      batch.mesh.boundingSphere = null; // its instances have moved since it was computed
      for (const hit of caster.intersectObject(batch.mesh, false)) {
        if (hit.distance < nearest.distance) nearest = { distance: hit.distance, node: batch.nodeAt(hit.instanceId ?? 0) };
      }
    }
    return nearest.node < 0 ? null : nearest.node;
  }

  // The Shape that is drawn at a place of the window, and where; null where there is none.
  shapeUnder(x: number, y: number): { path: string; point: Vector3 } | null {
    if (this.shown === null) return null;
    const caster = this.casterAt(x, y);
    let nearest: { distance: number; path: string; point: Vector3 } | null = null;
    const take = (distance: number, path: string | undefined, point: Vector3): void => {
      if (path !== undefined && (nearest === null || distance < nearest.distance)) nearest = { distance, path, point };
    };
    for (const hit of caster.intersectObject(this.shown.file.standing, true)) take(hit.distance, pathOf(hit.object), hit.point);
    for (const batch of this.shown.moving.batches) {
      batch.mesh.boundingSphere = null;
      for (const hit of caster.intersectObject(batch.mesh, false)) take(hit.distance, batch.pathAt(hit.instanceId ?? 0), hit.point);
    }
    return nearest;
  }

  // Draws some things elsewhere, and all others where they are, until the scene is another one.
  preview(previews: readonly Preview[]): void {
    if (this.shown === null) return;
    const { file, moving } = this.shown;
    moving.preview(previews);
    file.standing.traverse((part) => {
      const path = part instanceof Mesh ? pathOf(part) : undefined;
      if (path === undefined) return;
      const data = part.userData as { unmoved?: Matrix4 };
      const preview = previewAt(previews, path, file.standingNode);
      if (preview === undefined && data.unmoved === undefined) return;
      data.unmoved ??= part.matrixWorld.clone();
      part.matrixWorld.copy(data.unmoved);
      if (preview !== undefined) part.matrixWorld.premultiply(preview.motion);
      part.matrixWorldAutoUpdate = false;
    });
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
    shown.ghosts.update(shown.ghostFrames, this.frustum, shown.ghostColours, shown.groups);
  }

  private firstLook(file: SceneFile): void {
    const viewpoint = file.extras.viewpoints?.[0];
    this.rig.measure(this.bounds());
    if (viewpoint !== undefined) this.visit(viewpoint);
    else this.fit();
  }

  private clear(shown: Shown): void {
    shown.occlusion?.dispose();
    shown.file.standing.removeFromParent();
    for (const { object } of shown.file.carried) object.removeFromParent();
    shown.moving.dispose();
    shown.ghosts.dispose();
    for (const shape of shown.file.shapes) shape.geometry.dispose();
  }
}

function expandByShape(box: Box3, { geometry, nodeFromShape }: MovingShape): void {
  geometry.computeBoundingBox();
  if (geometry.boundingBox !== null) box.union(geometry.boundingBox.clone().applyMatrix4(nodeFromShape));
}

// A sheared Shape is two objects, of which the upper one has the path.
function pathOf(part: Object3D): string | undefined {
  const { path } = part.userData as { path?: string };
  return path ?? (part.parent?.userData as { path?: string } | undefined)?.path;
}
