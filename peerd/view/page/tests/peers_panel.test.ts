import type { Status } from 'peerd';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { PeersPanel } from '../src/panels/peers_panel';

// An element as far as a panel makes it: attributes, and children or texts.
class Element {
  readonly attributes = new Map<string, string>();
  children: (Element | string)[] = [];
  setAttribute(name: string, value: string): void {
    this.attributes.set(name, value);
  }
  append(...children: (Element | string)[]): void {
    this.children.push(...children);
  }
  replaceChildren(...children: (Element | string)[]): void {
    this.children = children;
  }
  get text(): string {
    return this.children.map((child) => (typeof child === 'string' ? child : child.text)).join('');
  }
  warnings(): string[] {
    const below = this.children.flatMap((child) => (typeof child === 'string' ? [] : child.warnings()));
    return this.attributes.get('class') === 'note warn' ? [this.text, ...below] : below;
  }
}

function status(troubles?: readonly string[]): Status {
  const session = { joined: true, time_s: 1, clock_offset_ms: 0, clock_error_ms: 0, sealed: true, sealed_by: 'a key' };
  return { peer: { id: 2, name: 'b' }, session, waits_for: [], members: [], counters: {}, troubles } as unknown as Status;
}

describe('the panel of peers', () => {
  beforeEach(() => vi.stubGlobal('document', { createElement: () => new Element() }));
  afterEach(() => vi.unstubAllGlobals());

  it('says what keeps the peer from the others, while it does', () => {
    const panel = new PeersPanel(), element = panel.element as unknown as Element;
    panel.update(status(['hears the peer of id 7, which hears nothing of this one']), null);
    expect(element.warnings()).toEqual(['This peer hears the peer of id 7, which hears nothing of this one.']);
    panel.update(status([]), null);
    expect(element.warnings()).toEqual([]);
    panel.update(status(), null);
    expect(element.warnings()).toEqual([]);
  });
});
