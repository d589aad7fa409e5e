import { Vector3 } from 'three';
import { type PoseBook, PoseFlag } from 'peerd';

import { make, setText } from '../page/make';
import type { Overlay, SceneView } from './scene_view';

// Names over objects: of those in the picture the ones that are nearest to the camera.
const kMost = 40;

export class Labels implements Overlay {
  readonly element = make('div', { class: 'labels', 'aria-hidden': 'true' });
  visible = false;
  private readonly pool: HTMLElement[] = [];
  private readonly point = new Vector3();

  constructor(private readonly bookOf: () => PoseBook) {}

  update(view: SceneView): void {
    this.element.hidden = !this.visible;
    if (!this.visible || view.file === null) return;
    const nearest = this.nearestOf(view);
    nearest.forEach((label, i) => this.place(i, label));
    for (let i = nearest.length; i < this.pool.length; ++i) this.pool[i].hidden = true;
  }

  private nearestOf(view: SceneView): { name: string; x: number; y: number; depth: number; whose: string }[] {
    const found = [];
    const { clientWidth: width, clientHeight: height } = this.element;
    const { shown } = this.bookOf();
    for (const node of view.file?.nodes ?? []) {
      if (view.frames?.position(node.index, this.point) !== true) continue;
      this.point.y += 0.75 * view.radiusOf(node);
      const p = this.point.project(view.rig.camera);
      if (p.z > 1 || Math.abs(p.x) > 1 || Math.abs(p.y) > 1) continue;
      const differs = (shown.flags[node.index] & PoseFlag.differs) !== 0;
      const whose = differs ? 'differs' : (shown.flags[node.index] & PoseFlag.own) !== 0 ? 'own' : shown.owner[node.index] === 0 ? 'nobodys' : 'remote';
      const name = node.def !== '' ? node.def : (node.path.split('/').at(-1) ?? node.path);
      found.push({ name, x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height, depth: p.z, whose });
    }
    return found.sort((a, b) => a.depth - b.depth).slice(0, kMost);
  }

  private place(i: number, label: { name: string; x: number; y: number; whose: string }): void {
    const element = (this.pool[i] ??= this.element.appendChild(make('span', { class: 'label' })));
    element.hidden = false;
    setText(element, label.name);
    element.dataset['whose'] = label.whose;
    element.style.transform = `translate(${label.x.toFixed(1)}px, ${label.y.toFixed(1)}px) translate(-50%, -100%)`;
  }
}
