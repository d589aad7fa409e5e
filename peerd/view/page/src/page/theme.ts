import { Setting } from './setting';

// Dark or light: the system's wish until the user has chosen, which the browser then remembers.
export type Theme = 'dark' | 'light';
const kKey = 'peerd.theme';

export class ThemeChoice {
  readonly theme: Setting<Theme>;
  private readonly system = window.matchMedia('(prefers-color-scheme: dark)');

  constructor() {
    this.theme = new Setting<Theme>(this.chosen() ?? this.wished());
    this.theme.follow((theme) => (document.documentElement.dataset['theme'] = theme));
    this.system.addEventListener('change', () => {
      if (this.chosen() === null) this.theme.value = this.wished();
    });
  }

  toggle(): void {
    this.theme.value = this.theme.value === 'dark' ? 'light' : 'dark';
    localStorage.setItem(kKey, this.theme.value);
  }

  private chosen(): Theme | null {
    const kept = localStorage.getItem(kKey);
    return kept === 'dark' || kept === 'light' ? kept : null;
  }

  private wished(): Theme {
    return this.system.matches ? 'dark' : 'light';
  }
}

export function cssColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
