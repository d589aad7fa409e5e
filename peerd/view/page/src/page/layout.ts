import { make } from './make';
import { Tabs, type Panel } from './tabs';

// Where things are: two docks beside the picture on a wide page, one on a narrow page, and a sheet below the picture on a
// phone's, which goes away when its shown tab is chosen again.
const kTwoDocks = '(min-width: 1101px)';

export class Layout {
  readonly element: HTMLElement;
  readonly stage = make('main', { class: 'stage', 'aria-label': 'The world' });
  private readonly left = new Tabs('Session');
  private readonly right = new Tabs('Tools');
  private readonly wide = window.matchMedia(kTwoDocks);

  constructor(
    header: HTMLElement,
    timeline: HTMLElement,
    private readonly leftPanels: readonly Panel[],
    private readonly rightPanels: readonly Panel[],
  ) {
    const leftDock = make('aside', { class: 'dock dock-left', 'aria-label': 'Session' }, this.left.element);
    const rightDock = make('aside', { class: 'dock dock-right', 'aria-label': 'Tools' }, this.right.element);
    this.element = make('div', { class: 'app' }, header, leftDock, this.stage, rightDock, timeline);
    this.right.onChoose = (_name, again) => this.element.classList.toggle('folded', again && !this.element.classList.contains('folded'));
    this.wide.addEventListener('change', () => this.arrange());
    this.arrange();
  }

  show(name: string): void {
    this.element.classList.remove('folded');
    for (const tabs of [this.left, this.right]) if (tabs.holds(name)) tabs.choose(name);
  }

  isShown(name: string): boolean {
    return this.left.isShown(name) || this.right.isShown(name);
  }

  badge(name: string, count: number): void {
    for (const tabs of [this.left, this.right]) tabs.badge(name, count);
  }

  private arrange(): void {
    this.left.hold(this.wide.matches ? this.leftPanels : []);
    this.right.hold(this.wide.matches ? this.rightPanels : [...this.rightPanels, ...this.leftPanels]);
    this.element.classList.toggle('one-dock', !this.wide.matches);
  }
}
