import { Group, Matrix4, Mesh, MeshBasicMaterial, Vector3, type BufferGeometry, type Frustum, type Material, type Object3D, type PerspectiveCamera } from 'three';

import type { InstanceBatch } from './instance_batch';
import { hullGeometry, kdopHull, type KdopHull } from './kdop_hull';
import { OcclusionState } from './occlusion_state';
import type { RigidFrames } from './rigid_frames';
import type { ViewGroups } from './view_groups';

// Leaves out what things that stand hide (the thesis, 3.1.2): the GPU is asked, for the 18-DOP of each Shape of many triangles,
// whether any part of it is in front of all that stands. A Shape of few triangles is cheaper to draw than to ask for. The same
// polytopes say what is outside of the picture.
//
//   what stands (renderOrder 0) -- polytopes, which write nothing (0.5) -- what moves (1)
const kLeastTriangles = 200;
const kMostQueries = 400; // in one picture: what cannot be asked for is drawn
const kMostCandidates = 1000; // those of the most triangles: our own time for a picture is bounded

const kBeforeProxies = 0; // renderOrder: what stands
const kOfProxies = 0.5;
export const kBehindProxies = 1; // what moves: it hides nothing

interface Occludee {
  readonly proxy: Mesh;
  readonly hull: KdopHull;
  readonly triangles: number;
  readonly standing: Mesh | null; // or an instance of a batch:
  readonly batch: InstanceBatch | null;
  readonly instance: number;
  readonly lastPlace: Matrix4;
  place: number; // how often it has moved
  query: WebGLQuery | null;
}

export interface OcclusionFigures {
  readonly candidates: number;
  readonly leftOut: number;
  readonly outside: number; // of the picture
  readonly queries: number; // each is a draw call of a few triangles
  readonly queryTriangles: number;
}

export class Occlusion {
  figures: OcclusionFigures = { candidates: 0, leftOut: 0, outside: 0, queries: 0, queryTriangles: 0 };
  private readonly proxies = new Group();
  private readonly material = new MeshBasicMaterial({ colorWrite: false, depthWrite: false });
  private readonly all: Occludee[] = [];
  private readonly hulls = new Map<BufferGeometry, { hull: KdopHull; geometry: BufferGeometry } | null>();
  private readonly state: OcclusionState;
  private readonly centre = new Vector3();
  private readonly point = new Vector3();
  private readonly eye = new Vector3();
  private readonly lastView = new Matrix4();
  private view = 0; // how often the camera has moved

  constructor(private readonly gl: WebGL2RenderingContext, scene: Object3D, standing: Object3D, batches: readonly InstanceBatch[]) {
    this.proxies.matrixAutoUpdate = false;
    standing.traverse((part) => {
      part.renderOrder = kBeforeProxies;
      if (part instanceof Mesh) this.add(part as Mesh<BufferGeometry, Material>, null, 0);
    });
    for (const batch of batches) for (let i = 0; i < batch.count; ++i) this.add(batch.mesh, batch, i);
    this.all.sort((a, b) => b.triangles - a.triangles);
    for (const one of this.all.splice(kMostCandidates)) if (one.standing !== null) one.standing.frustumCulled = true;
    for (const one of this.all) this.proxies.add(one.proxy);
    this.state = new OcclusionState(this.all.length);
    scene.add(this.proxies);
  }

  // Before a picture, whose projection `viewProjection` is: takes the answers, says what is left out, and what is asked.
  update(frames: RigidFrames, frustum: Frustum, viewProjection: Matrix4, camera: PerspectiveCamera, groups: ViewGroups): void {
    let [leftOut, outside, queries, queryTriangles] = [0, 0, 0, 0];
    this.eye.setFromMatrixPosition(camera.matrixWorld);
    if (!this.lastView.equals(viewProjection)) this.view += 1;
    this.lastView.copy(viewProjection);
    this.state.begin(this.view);
    this.all.forEach((one, i) => {
      const { proxy } = one;
      this.takeAnswer(one, i);
      const known = one.batch === null || one.batch.worldOf(one.instance, frames, groups, proxy.matrixWorld);
      if (!one.lastPlace.equals(proxy.matrixWorld)) one.place += 1;
      one.lastPlace.copy(proxy.matrixWorld);
      const inside = known && this.isInside(one, frustum);
      const unsure = this.isAround(one, camera.near);
      const hidden = inside && !unsure && this.state.isLeftOut(i, one.place);
      const isThere = !(one.batch?.isHiddenByGroup(one.instance, groups) ?? false);
      proxy.visible = inside && !unsure && isThere && queries < kMostQueries && this.state.shouldAsk(i, one.place);
      if (proxy.visible) {
        this.state.ask(i, one.place);
        queries += 1;
        queryTriangles += one.hull.corners.length / 3;
      }
      leftOut += hidden ? 1 : 0;
      outside += inside ? 0 : 1;
      if (one.standing !== null) one.standing.visible = inside && !hidden;
      else one.batch?.leaveOut(one.instance, !inside || hidden);
    });
    this.figures = { candidates: this.all.length, leftOut, outside, queries, queryTriangles };
  }

  // Everything is drawn again.
  end(): void {
    for (const { proxy } of this.all) proxy.visible = false;
    for (const one of this.all) {
      if (one.standing !== null) one.standing.visible = true;
      else one.batch?.leaveOut(one.instance, false);
    }
  }

  dispose(): void {
    this.end();
    this.proxies.removeFromParent();
    for (const one of this.all) if (one.query !== null) this.gl.deleteQuery(one.query);
    for (const kept of this.hulls.values()) kept?.geometry.dispose();
    this.material.dispose();
  }

  private add(mesh: Mesh, batch: InstanceBatch | null, instance: number): void {
    const { geometry } = mesh;
    const triangles = (geometry.index?.count ?? geometry.getAttribute('position').count) / 3;
    if (triangles < kLeastTriangles || (geometry.userData as { form?: number }).form !== undefined) return;
    let kept = this.hulls.get(geometry);
    if (kept === undefined) {
      const hull = kdopHull(geometry.getAttribute('position').array);
      kept = hull === null ? null : { hull, geometry: hullGeometry(hull) };
      this.hulls.set(geometry, kept);
    }
    if (kept === null) return;
    const proxy = new Mesh(kept.geometry, this.material);
    proxy.matrixAutoUpdate = proxy.matrixWorldAutoUpdate = false;
    proxy.frustumCulled = false;
    proxy.visible = false;
    proxy.renderOrder = kOfProxies;
    const one: Occludee = { proxy, hull: kept.hull, triangles, standing: batch === null ? mesh : null, batch, instance, lastPlace: new Matrix4(), place: 0, query: null };
    if (batch === null) {
      mesh.updateWorldMatrix(true, false);
      proxy.matrixWorld.copy(mesh.matrixWorld);
      mesh.frustumCulled = false;
    }
    proxy.onBeforeRender = () => {
      one.query ??= this.gl.createQuery();
      if (one.query !== null) this.gl.beginQuery(this.gl.ANY_SAMPLES_PASSED_CONSERVATIVE, one.query);
    };
    proxy.onAfterRender = () => this.gl.endQuery(this.gl.ANY_SAMPLES_PASSED_CONSERVATIVE);
    this.all.push(one);
  }

  private takeAnswer({ query }: Occludee, i: number): void {
    if (query === null || !this.state.isAsked(i) || this.gl.getQueryParameter(query, this.gl.QUERY_RESULT_AVAILABLE) !== true) return;
    this.state.answer(i, Number(this.gl.getQueryParameter(query, this.gl.QUERY_RESULT)) === 0);
  }

  private isInside({ hull, proxy }: Occludee, frustum: Frustum): boolean {
    const reach = this.sphereOf(proxy);
    for (const plane of frustum.planes) {
      const distance = plane.distanceToPoint(this.centre);
      if (distance > reach) continue;
      if (distance < -reach) return false;
      let nearest = -Infinity;
      for (let i = 0; i < hull.points.length && nearest < 0; i += 3) {
        this.point.set(hull.points[i], hull.points[i + 1], hull.points[i + 2]).applyMatrix4(proxy.matrixWorld);
        nearest = Math.max(nearest, plane.distanceToPoint(this.point));
      }
      if (nearest < 0) return false;
    }
    return true;
  }

  // A polytope that the near plane may cut shows only its back, which is not drawn.
  private isAround({ proxy }: Occludee, near: number): boolean {
    const reach = this.sphereOf(proxy);
    return this.centre.distanceTo(this.eye) < reach + 3 * near;
  }

  // The sphere around a proxy in the world: its centre is `centre`, its radius the result.
  private sphereOf({ geometry, matrixWorld }: Mesh): number {
    if (geometry.boundingSphere === null) geometry.computeBoundingSphere();
    const sphere = geometry.boundingSphere;
    if (sphere === null) return Infinity;
    this.centre.copy(sphere.center).applyMatrix4(matrixWorld);
    return sphere.radius * matrixWorld.getMaxScaleOnAxis();
  }
}
