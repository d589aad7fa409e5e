import type { Viewpoint } from '../scene/scene_file';
import type { GroupExtras } from '../scene/view_groups';
import { icon } from './icons';
import { fill, make } from './make';

// What is clicked below an Anchor offers its link; it is followed only where the offer is taken.
export type AnchorTarget =
  | { readonly kind: 'viewpoint'; readonly viewpoint: Viewpoint }
  | { readonly kind: 'link'; readonly address: string }
  | { readonly kind: 'none'; readonly text: string };

// The first of the URLs that the page can follow: a Viewpoint of this world by `#NAME`, or a page of the web. What is relative
// to the world's file has no address that a browser knows.
export function anchorTarget(urls: readonly string[], viewpoints: readonly Viewpoint[]): AnchorTarget {
  for (const url of urls) {
    const viewpoint = url.startsWith('#') ? viewpoints.find(({ def }) => def === url.slice(1)) : undefined;
    if (viewpoint !== undefined) return { kind: 'viewpoint', viewpoint };
    if (/^https?:\/\//i.test(url)) return { kind: 'link', address: url };
  }
  return { kind: 'none', text: urls[0] ?? '' };
}

// The innermost Anchor around a path.
export function anchorAround(path: string, groups: readonly GroupExtras[]): GroupExtras | null {
  const around = groups.filter((group) => group.kind === 'anchor' && path.startsWith(`${group.path}/`));
  return around.reduce<GroupExtras | null>((inner, group) => (inner === null || group.path.length > inner.path.length ? group : inner), null);
}

export class AnchorOffer {
  readonly element = make('div', { class: 'anchor-offer', role: 'status', 'aria-live': 'polite', hidden: true });

  constructor(private readonly visit: (viewpoint: Viewpoint) => void) {}

  hide(): void {
    this.element.hidden = true;
  }

  show(anchor: GroupExtras, viewpoints: readonly Viewpoint[]): void {
    const target = anchorTarget(anchor.url ?? [], viewpoints);
    const name = anchor.description !== undefined && anchor.description !== '' ? anchor.description : anchor.path;
    fill(
      this.element,
      make('div', { class: 'anchor-text' }, make('strong', {}, name), make('span', { class: 'muted small' }, place(target))),
      this.follow(target),
      make('button', { type: 'button', class: 'quiet', 'aria-label': 'Dismiss', click: () => this.hide() }, icon('close')),
    );
    this.element.hidden = false;
  }

  private follow(target: AnchorTarget): HTMLElement | null {
    if (target.kind === 'none') return null;
    if (target.kind === 'link') {
      return make('a', { class: 'button primary', href: target.address, target: '_blank', rel: 'noopener noreferrer', click: () => this.hide() }, 'Open');
    }
    const go = (): void => {
      this.visit(target.viewpoint);
      this.hide();
    };
    return make('button', { type: 'button', class: 'button primary', click: go }, 'Go there');
  }
}

function place(target: AnchorTarget): string {
  if (target.kind === 'link') return `leads to ${target.address}`;
  if (target.kind === 'viewpoint') return `leads to the viewpoint ${target.viewpoint.description || (target.viewpoint.def ?? '')}`;
  return target.text === '' ? 'leads nowhere: it has no url' : `leads to ${target.text}, which this page cannot open`;
}
