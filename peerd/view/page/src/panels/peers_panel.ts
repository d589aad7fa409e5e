import type { PeerRow, PeersReply, Status } from 'peerd';

import { fill, make } from '../page/make';
import type { Panel } from '../page/tabs';
import type { Recording } from '../live/recording';
import { bytesText, millisecondsText, shareText } from './numbers';

// This peer and the others: delay, loss and clock error.
export class PeersPanel implements Panel {
  readonly name = 'peers';
  readonly title = 'Peers';
  readonly element = make('div', { class: 'panel' });

  // Of a recording there are the peers' names.
  showRecorded(recording: Recording): void {
    const views = new Set(recording.views.map((view) => view.peer));
    const rows = recording.peers.map(({ id, name }) => card(name, id, views.has(id) ? 'own' : 'remote', views.has(id) ? 'its view is recorded' : 'its view is not recorded', []));
    fill(this.element, ...rows, make('p', { class: 'note' }, 'Delays, losses and clocks are in the report of the run.'));
  }

  update(status: Status | null, reply: PeersReply | null): void {
    if (status === null) {
      fill(this.element, make('p', { class: 'note' }, 'No word from the peer yet.'));
      return;
    }
    const waits = status.waits_for.map((peer) => peer.name).join(', ');
    fill(
      this.element,
      this.ownCard(status, reply),
      waits !== '' && make('p', { class: 'note warn' }, `Nothing moves before ${waits} has come.`),
      ...(status.troubles ?? []).map((trouble) => make('p', { class: 'note warn' }, `This peer ${trouble}.`)),
      ...(reply?.peers ?? []).map((peer) => this.cardOf(peer)),
      (reply?.peers.length ?? 0) === 0 && make('p', { class: 'note' }, 'No other peer is here.'),
    );
  }

  private ownCard(status: Status, reply: PeersReply | null): HTMLElement {
    const follows = reply?.clock.follows;
    const lead = follows === undefined ? '' : follows === status.peer.id ? 'its clock is the session’s' : `follows the clock of peer ${follows}`;
    return card(status.peer.name, status.peer.id, 'own', status.session.joined ? `This page’s peer${lead === '' ? '' : '; ' + lead}` : 'This page’s peer; not in a session yet', [
      ['Clock error', millisecondsText(status.session.clock_error_ms)],
      ['Received', bytesText(status.counters['bytes_in'])],
      ['Sent', bytesText(status.counters['bytes_out'])],
    ]);
  }

  private cardOf(peer: PeerRow): HTMLElement {
    const state = peer.joined ? (peer.leads ? 'its clock is the session’s' : 'in the session') : 'not in a session';
    return card(peer.name, peer.id, 'remote', state, [
      ['Delay', millisecondsText(peer.delay_ms)],
      ['Round trip', millisecondsText(peer.round_trip_ms)],
      ['Loss in / out', `${shareText(peer.loss_in)} / ${shareText(peer.loss_out)}`],
      ['Clock error', millisecondsText(peer.clock_error_ms)],
      ['Last heard', peer.heard_ms_ago === null ? '–' : `${millisecondsText(peer.heard_ms_ago)} ago`],
      ['Received', bytesText(peer.bytes_in)],
    ]);
  }
}

function card(name: string, id: number, whose: string, state: string, facts: readonly (readonly [string, string])[]): HTMLElement {
  const rows = facts.flatMap(([term, value]) => [make('dt', {}, term), make('dd', {}, value)]);
  return make(
    'article',
    { class: 'card', 'data-peer': id },
    make('header', {}, make('span', { class: 'dot', 'data-whose': whose }), make('strong', {}, name), make('span', { class: 'muted' }, `id ${id}`)),
    make('p', { class: 'muted small' }, state),
    make('dl', { class: 'facts' }, ...rows),
  );
}
