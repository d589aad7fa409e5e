import type { Ask, HierarchyReply } from 'peerd';

import { SurroundingsWatch } from './live/surroundings';
import type { Options } from './page/toolbar';
import { HierarchyMarks } from './scene/hierarchy_marks';
import { ProximityMarks } from './scene/proximity_marks';
import { RegionMarks } from './scene/region_marks';
import type { SceneView } from './scene/scene_view';

// What the peer knows beside the picture, drawn over it where a switch says so: the regions, the proximity spheres, and a level
// of the hierarchy of what is selected.
export interface InsightHost {
  selectedPath(): string | null;
  drawSoon(): void;
  onFault(sentence: string): void;
}

export class Insight {
  readonly watch: SurroundingsWatch;
  readonly proximity: ProximityMarks;
  readonly regions: RegionMarks;
  hierarchy: HierarchyReply | null = null;
  private readonly marks = new HierarchyMarks();
  private asked = '';

  constructor(view: SceneView, private readonly ask: Ask, private readonly options: Options, private readonly host: InsightHost) {
    this.watch = new SurroundingsWatch(ask, () => options.proximity.value || options.regions.value, () => host.drawSoon(), (sentence) => host.onFault(sentence));
    this.proximity = new ProximityMarks(() => this.watch.newest);
    this.regions = new RegionMarks(() => this.watch.newest);
    view.overlays.push(this.proximity, this.regions, this.marks);
    options.proximity.follow((on) => (this.proximity.visible = on));
    options.regions.follow((on) => (this.regions.visible = on));
    for (const setting of [options.proximity, options.regions]) {
      setting.follow(() => {
        void this.watch.poll();
        host.drawSoon();
      });
    }
    options.hierarchy.follow(() => void this.refresh(true));
    options.hierarchyLevel.follow(() => void this.refresh(true));
  }

  // Once the selection or the scene is another one.
  async refresh(anew = false): Promise<void> {
    const { hierarchy, hierarchyLevel, hierarchyText } = this.options;
    const path = this.host.selectedPath();
    if (!hierarchy.value || path === null) {
      this.asked = '';
      this.show(null);
      hierarchyText.value = hierarchy.value ? 'select an object' : '';
      return;
    }
    const asked = `${path} ${hierarchyLevel.value}`;
    if (asked === this.asked && !anew) return;
    this.asked = asked;
    const reply = await this.ask({ do: 'hierarchy', path, level: hierarchyLevel.value });
    if (asked !== this.asked) return;
    if (reply.ok) this.show(reply as unknown as HierarchyReply);
    else this.show(null);
    hierarchyText.value = reply.ok ? sentenceOf(reply as unknown as HierarchyReply) : (reply.error ?? 'refused');
  }

  private show(reply: HierarchyReply | null): void {
    this.hierarchy = reply;
    this.marks.show(reply);
    this.host.drawSoon();
  }
}

export function sentenceOf({ level, volumes, is_last, left_out, triangles }: HierarchyReply): string {
  const count = volumes.length + left_out;
  const more = left_out > 0 ? `, ${left_out} not shown` : '';
  return `level ${level}: ${count} ${count === 1 ? 'volume' : 'volumes'}${more} for ${triangles} triangles${is_last ? '; the last one' : ''}`;
}
