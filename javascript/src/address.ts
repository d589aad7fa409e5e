/** Where a peer's gateway is. */
export interface GatewayAddress {
  /** Of pages, without token: `http://HOST:PORT/`. */
  readonly page: string;
  /** Of the WebSocket. */
  readonly live: string;
  /** From the fragment, which no browser sends; null: there is none, and this program may only look. */
  readonly token: string | null;
}

/** The parts of the address that a peer prints, `http://HOST:PORT/#token=TOKEN`. Throws a TypeError where it is no address. */
export function gatewayAddress(printed: string | URL): GatewayAddress {
  const page = parsed(printed);
  if (page === null || !['http:', 'https:'].includes(page.protocol)) throw new TypeError(`"${String(printed)}" is not the address of a peer, which is like http://127.0.0.1:8080/#token=..`);
  const token = new URLSearchParams(page.hash.replace(/^#/, '')).get('token');
  page.hash = '';
  const live = new URL('api/v1/live', page);
  live.protocol = page.protocol === 'https:' ? 'wss:' : 'ws:';
  return { page: page.href, live: live.href, token };
}

function parsed(address: string | URL): URL | null {
  try {
    return new URL(address);
  } catch {
    return null; // which the caller says in words of its own
  }
}
