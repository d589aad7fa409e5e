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
  const page = new URL(printed);
  if (page.protocol !== 'http:' && page.protocol !== 'https:') throw new TypeError(`${page.protocol}//.. is not the address of a peer's page, which begins with http:`);
  const token = new URLSearchParams(page.hash.replace(/^#/, '')).get('token');
  page.hash = '';
  const live = new URL('api/v1/live', page);
  live.protocol = page.protocol === 'https:' ? 'wss:' : 'ws:';
  return { page: page.href, live: live.href, token };
}
