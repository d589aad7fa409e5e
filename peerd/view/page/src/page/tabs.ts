import { make, setText } from './make';

// Panels of one dock, one of them shown. The arrow keys go from tab to tab.
export interface Panel {
  readonly name: string;
  readonly title: string;
  readonly element: HTMLElement;
}

export class Tabs {
  readonly element: HTMLElement;
  private readonly list: HTMLElement;
  private readonly body: HTMLElement;
  private panels: Panel[] = [];
  private active = '';
  onChoose: ((name: string, again: boolean) => void) | null = null;

  constructor(label: string) {
    this.list = make('div', { class: 'tabs', role: 'tablist', 'aria-label': label });
    this.body = make('div', { class: 'tab-body' });
    this.element = make('section', { class: 'tab-set', 'aria-label': label }, this.list, this.body);
    this.list.addEventListener('keydown', (event) => this.onKey(event));
  }

  hold(panels: readonly Panel[]): void {
    this.panels = [...panels];
    this.list.replaceChildren(...panels.map((panel) => this.tabOf(panel)));
    this.body.replaceChildren(...panels.map((panel) => panel.element));
    for (const panel of panels) {
      panel.element.setAttribute('role', 'tabpanel');
      panel.element.setAttribute('aria-label', panel.title);
    }
    this.choose(panels.some((panel) => panel.name === this.active) ? this.active : (panels[0]?.name ?? ''));
  }

  holds(name: string): boolean {
    return this.panels.some((panel) => panel.name === name);
  }

  isShown(name: string): boolean {
    return this.active === name && this.element.offsetParent !== null;
  }

  choose(name: string): void {
    this.active = name;
    for (const panel of this.panels) panel.element.hidden = panel.name !== name;
    for (const tab of this.list.querySelectorAll('button')) {
      const chosen = tab.dataset['panel'] === name;
      tab.setAttribute('aria-selected', String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
    }
  }

  // A number beside a tab's title; 0: none.
  badge(name: string, count: number): void {
    const mark = this.list.querySelector(`[data-panel="${name}"] .badge`);
    if (mark !== null) setText(mark, count > 0 ? String(count) : '');
  }

  private tabOf(panel: Panel): HTMLElement {
    const choose = (): void => {
      const again = this.active === panel.name;
      this.choose(panel.name);
      this.onChoose?.(panel.name, again);
    };
    return make(
      'button',
      { type: 'button', role: 'tab', class: 'tab', 'data-panel': panel.name, click: choose },
      panel.title,
      make('span', { class: 'badge' }),
    );
  }

  private onKey(event: KeyboardEvent): void {
    const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    if (step === 0) return;
    const at = this.panels.findIndex((panel) => panel.name === this.active);
    const next = this.panels[(at + step + this.panels.length) % this.panels.length];
    this.choose(next.name);
    this.list.querySelector<HTMLElement>(`[data-panel="${next.name}"]`)?.focus();
    event.preventDefault();
  }
}
