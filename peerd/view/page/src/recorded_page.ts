import type { ContactBook } from './contact_book';
import type { PeerLink } from './live/peer_link';
import { fetchErrors, fetchErrorsOf, fetchEvents, fetchStretch, sceneAddress, type Recording } from './live/recording';
import type { Header } from './page/header';
import { RunTimeline } from './page/run_timeline';
import { eventText } from './panels/event_text';
import type { LogPanel } from './panels/log_panel';
import { RunCharts } from './panels/run_charts';
import { loadSceneFile, type SceneFile } from './scene/scene_file';
import type { Playhead } from './time/playhead';
import { RecordedFrames } from './time/recorded_frames';

// The page of a recording: whose view is shown, and with it the scene of the shown instant, the contacts, the log, the
// errors. What needs a running peer is off.
export interface RecordedParts {
  readonly head: Playhead;
  readonly link: PeerLink;
  readonly contacts: ContactBook;
  readonly header: Header;
  readonly log: LogPanel;
  showScene(file: SceneFile): void;
  drawSoon(): void;
  fault(sentence: string): void;
}

export class RecordedPage {
  readonly timeline: RunTimeline;
  readonly charts: RunCharts;
  view = -1;
  private frames: RecordedFrames | null = null;
  private revision = -1; // of the scene that is shown, or on its way
  private shownRevision = -1;
  private selected: string | null = null;

  constructor(readonly recording: Recording, private readonly parts: RecordedParts) {
    this.timeline = new RunTimeline(parts.head, recording, (view) => void this.show(view));
    this.charts = new RunCharts(recording.end_s, recording.hz, recording.kind === 'run');
    for (const note of recording.notes) parts.fault(note);
  }

  async show(view: number): Promise<void> {
    const { recording, parts } = this;
    const seen = recording.views[view];
    if (seen === undefined || view === this.view) return;
    this.view = view;
    this.revision = this.shownRevision = -1;
    this.timeline.showView(view);
    parts.link.showRecorded(seen.peer, seen.name, recording.peers);
    parts.header.setRecording(seen.name, recording);
    const arrived = (): void => {
      parts.head.refresh();
      parts.drawSoon();
    };
    this.frames = new RecordedFrames(seen, recording.end_s, (stretch) => fetchStretch(view, stretch), arrived, (sentence) => parts.fault(sentence));
    const isFirst = parts.head.history.grows;
    parts.head.showRecorded(this.frames);
    if (isFirst) parts.head.pauseAt(this.frames.first_s);
    this.follow();
    await Promise.all([this.showEvents(view), this.showErrors(view)]);
  }

  // Once a picture: the scene is that of the shown instant.
  follow(): void {
    const { parts, frames } = this;
    const revision = frames?.revisionAt(parts.head.shownAt(0));
    if (revision === undefined || revision === this.revision) return;
    this.revision = revision;
    void this.showScene(this.view, revision);
  }

  // The errors of one object, by its id.
  async select(id: string | null): Promise<void> {
    if (id === this.selected) return;
    this.selected = id;
    const errors = id === null ? new Float32Array(0) : await fetchErrorsOf(this.view, id).catch(() => new Float32Array(0));
    if (id === this.selected) this.charts.showSelected(errors);
  }

  // Whether the scene is that of the shown instant.
  get sceneIsShown(): boolean {
    return this.shownRevision >= 0 && this.frames?.revisionAt(this.parts.head.shownAt(0)) === this.shownRevision;
  }

  // A sentence about the shown instant, where there is something to say.
  get remark(): string {
    const { frames, recording, parts } = this;
    if (frames === null || frames.isThere(parts.head.shownAt(0))) return '';
    return `${recording.views[this.view].name} is not there at that time.`;
  }

  private async showScene(view: number, revision: number): Promise<void> {
    try {
      const file = await loadSceneFile(sceneAddress(view, revision));
      if (view !== this.view || revision !== this.revision) return;
      this.parts.showScene(file);
      this.shownRevision = revision;
    } catch (fault) {
      this.parts.fault(`the scene cannot be shown: ${fault instanceof Error ? fault.message : String(fault)}`);
    }
  }

  private async showEvents(view: number): Promise<void> {
    const events = await fetchEvents(view);
    if (view !== this.view) return;
    const { contacts, log, link } = this.parts;
    contacts.clear();
    log.clear();
    for (const [t_s, event] of events) {
      const concerns = contacts.take(event);
      if (event.event === 'contacts_retracted' && concerns === 0) continue;
      log.add(event.event === 'contact' ? 'contact' : 'event', eventText(event, (peer) => link.nameOf(peer)), `${t_s.toFixed(2)} s`);
    }
    this.parts.drawSoon();
  }

  private async showErrors(view: number): Promise<void> {
    const errors = await fetchErrors(view);
    if (view !== this.view) return;
    this.charts.show(errors);
    const { selected } = this;
    this.selected = null;
    await this.select(selected);
  }
}
