import { describe, expect, it } from 'vitest';

import { remarkOn } from '../src/page/remarks';

describe('what the page says over the picture', () => {
  it('is nothing while the world comes', () => {
    expect(remarkOn('open', 0, { waits_for: [] })).toBe('');
    expect(remarkOn('connecting', 0, null)).toBe('');
  });

  it('is that the peer is away, before all else', () => {
    expect(remarkOn('closed', 4, { waits_for: [{ id: 2, name: 'bo' }] })).toMatch(/^No connection/);
  });

  it('is how old the picture is, where nothing comes', () => {
    expect(remarkOn('open', 4, { waits_for: [] })).toContain('for 4 s');
  });

  it('is whom the peer waits for', () => {
    const waits_for = [{ id: 2, name: 'bo' }, { id: 7, name: '' }];
    expect(remarkOn('open', 0, { waits_for })).toBe('The peer waits for bo, peer 7: nothing moves until all are here.');
  });
});
