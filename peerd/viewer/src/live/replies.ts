// What the daemon's replies and events hold, as docs/reference/control-protocol.md and gateway.md say it. Only what the
// page reads is named.
export type Numbers3 = readonly [number, number, number];
export type Numbers4 = readonly [number, number, number, number];

export interface Status {
  readonly peer: { readonly id: number; readonly name: string };
  readonly session: { readonly joined: boolean; readonly time_s: number | null; readonly clock_error_ms: number | null };
  readonly world_time_s: number | null;
  readonly since_start_s: number | null;
  readonly waits_for: readonly { readonly id: number; readonly name: string }[];
  readonly members: readonly { readonly id: number; readonly name: string; readonly joined: boolean }[];
  readonly counters: Readonly<Record<string, number>>;
}

export interface PeerRow {
  readonly id: number;
  readonly name: string;
  readonly joined: boolean;
  readonly leads: boolean;
  readonly heard_ms_ago: number | null;
  readonly round_trip_ms: number | null;
  readonly delay_ms: number | null;
  readonly clock_error_ms: number | null;
  readonly clock_ahead_ms: number | null;
  readonly loss_in: number | null;
  readonly loss_out: number | null;
  readonly bytes_in: number;
}

export interface PeersReply {
  readonly clock: { readonly follows: number; readonly error_ms: number | null };
  readonly peers: readonly PeerRow[];
  readonly next: number | null;
}

export interface Hit {
  readonly node: number;
  readonly id: string | number;
  readonly path: string;
  readonly owner: number | null;
  readonly shape?: { readonly path: string };
  readonly distance_m: number;
  readonly position_m: Numbers3;
  readonly normal: Numbers3;
}

export interface Inspected {
  readonly id: string | number;
  readonly path: string;
  readonly def: string | null;
  readonly type: string;
  readonly owner: number | null;
  readonly own: boolean;
  readonly driven: boolean;
  readonly threshold_m: number | null;
  readonly fields: Readonly<Record<string, string>>;
  readonly data: Readonly<Record<string, string>>;
}

export interface ContactEvent {
  readonly at_s: number;
  readonly kind: 'owner' | 'decided' | 'predicted' | 'applied' | 'scene';
  readonly decider?: number | null;
  readonly collider: string;
  readonly collidee: string;
  readonly collider_position_m?: Numbers3;
  readonly collidee_position_m?: Numbers3;
  readonly normal: Numbers3;
}
