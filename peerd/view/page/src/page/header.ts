import type { LinkState, Status } from 'peerd';

import type { Recording } from '../live/recording';
import { clockText, millisecondsText } from '../panels/numbers';
import { icon } from './icons';
import { make, setText } from './make';
import type { ThemeChoice } from './theme';

// Whose page it is, of which world, and how its session is.
export class Header {
  readonly element: HTMLElement;
  private readonly world = make('span', { class: 'world' });
  private readonly peer = make('span', { class: 'peer-name' }, '…');
  private readonly session = make('span', { class: 'session muted' });
  private readonly link = make('span', { class: 'link-dot', role: 'img' });
  private readonly why = make('span', { class: 'wide-only' });
  private readonly readOnly = make('span', { class: 'chip warn read-only', hidden: true }, icon('lock'), 'Read-only', this.why);

  private readonly recorded = make('span', { class: 'chip recorded', hidden: true, title: 'What is shown has happened: nothing can be changed in it.' }, 'Recorded');

  constructor(theme: ThemeChoice, openHelp: () => void) {
    const themeButton = make('button', { type: 'button', class: 'tool', 'aria-label': 'Dark or light', title: 'Dark or light', click: () => theme.toggle() });
    theme.theme.follow((now) => themeButton.replaceChildren(icon(now === 'dark' ? 'sun' : 'moon')));
    const help = make('button', { type: 'button', class: 'tool', 'aria-label': 'Help', title: 'Help', click: openHelp }, icon('help'));
    this.element = make(
      'header',
      { class: 'bar' },
      make('span', { class: 'brand' }, make('i', { class: 'mark', 'aria-hidden': 'true' }), make('span', { class: 'brand-name' }, 'peerd')),
      make('span', { class: 'who' }, this.link, this.peer, this.world),
      this.readOnly,
      this.recorded,
      this.session,
      make('span', { class: 'bar-tools' }, themeButton, help),
    );
  }

  // `token`: what has become of the one that the page was opened with.
  setMayEdit(mayEdit: boolean, state: LinkState, token: 'none' | 'accepted' | 'refused'): void {
    this.readOnly.hidden = mayEdit || state !== 'open';
    const isOld = token === 'refused';
    setText(this.why, isOld ? ': its token is of an earlier start' : ': opened without a token');
    this.readOnly.title = isOld
      ? 'The peer was started again since this address was made: its log has another one now, and peerd view says it.'
      : 'This page was opened without the token that the peer’s log shows, so it can change nothing.';
  }

  setState(state: LinkState): void {
    this.link.dataset['state'] = state;
    this.link.setAttribute('aria-label', state === 'open' ? 'connected to the peer' : 'no connection to the peer');
  }

  // Whose view of what is recorded.
  setRecording(name: string, recording: Recording): void {
    setText(this.peer, name);
    setText(this.session, `${recording.name}: ${recording.title}`);
    document.title = `${name} · ${recording.name} · peerd`;
    this.link.dataset['state'] = 'recorded';
    this.link.setAttribute('aria-label', 'a recording');
    this.readOnly.hidden = true;
    this.recorded.hidden = false;
  }

  setWorld(name: string): void {
    setText(this.world, name);
  }

  setStatus(status: Status): void {
    setText(this.peer, status.peer.name);
    document.title = `${status.peer.name} · peerd`;
    const others = status.members.filter((member) => member.joined).length;
    const peers = others === 0 ? 'alone' : others === 1 ? 'with 1 peer' : `with ${others} peers`;
    const { joined, clock_error_ms } = status.session;
    setText(this.session, joined ? `${clockText(status.world_time_s)} world time, ${peers}, clock ±${millisecondsText(clock_error_ms)}` : 'not in a session yet');
  }
}
