import { Box3, Vector3 } from 'three';
import { type DaemonEvent, gatewayAddress, type Hit, type Outcome, PoseFlag, type PoseFrame } from 'peerd';

import { ContactBook } from './contact_book';
import { Avatar, sizesOf } from './hand/avatar';
import { Hand } from './hand/hand';
import { Keys } from './hand/keys';
import { pick } from './hand/picking';
import { Proximity } from './hand/proximity';
import { Sensors } from './hand/sensors';
import { walkStart } from './hand/walk_start';
import { PointerTools, type Tool } from './hand/pointer_tools';
import { Insight } from './insight';
import { PeerLink } from './live/peer_link';
import { askForRecording, type Recording } from './live/recording';
import { AnchorOffer, anchorAround } from './page/anchor_offer';
import { Header } from './page/header';
import { Help } from './page/help';
import { Layout } from './page/layout';
import { make } from './page/make';
import { blindNote, remarkOn } from './page/remarks';
import { Notices } from './page/notices';
import { Setting } from './page/setting';
import { cssColour, ThemeChoice } from './page/theme';
import { RunTimeline } from './page/run_timeline';
import { Timeline } from './page/timeline';
import { cameraModeOf, Toolbar, type Options } from './page/toolbar';
import { ChartsPanel } from './panels/charts_panel';
import { eventText } from './panels/event_text';
import { InspectorPanel } from './panels/inspector_panel';
import { LogPanel, type LogKind } from './panels/log_panel';
import { ObjectsPanel } from './panels/objects_panel';
import { PeersPanel } from './panels/peers_panel';
import { Speedometer } from './panels/speedometer';
import { TreePanel } from './panels/tree_panel';
import { WorldPanel } from './panels/world_panel';
import { RecordedPage } from './recorded_page';
import { ContactMarks } from './scene/contact_marks';
import { Labels } from './scene/labels';
import { hasNode, nodeAround, type SceneFile } from './scene/scene_file';
import { SceneLoader } from './scene/scene_loader';
import { SceneView } from './scene/scene_view';
import { SelectionBox } from './scene/selection_box';
import { ThresholdMarks } from './scene/threshold_marks';
import { TruthShapes } from './scene/truth_shapes';
import { Selection } from './selection';
import { Playhead } from './time/playhead';

// The page: it joins the connection, the picture, the panels and the time line. Each of them knows none of the others.
const kHz = 30;
const kPanels_ms = 250;
const kErrors_ms = 100;
const kDrop_m = 0.05; // an avatar begins above the ground
const kLeastPictures = 4;
const kStillFor_s = 0.7; // how long the picture is drawn on after the last thing that may have changed it

export class Viewer {
  readonly options: Options = {
    ownerColours: new Setting(false),
    ghosts: new Setting(false),
    truth: new Setting(false),
    thresholds: new Setting(false),
    contacts: new Setting(true),
    labels: new Setting(false),
    proximity: new Setting(false),
    regions: new Setting(false),
    hierarchy: new Setting(false),
    hierarchyLevel: new Setting(0),
    hierarchyText: new Setting(''),
    occlusion: new Setting(true),
    cameraKeys: new Setting(false),
    tool: new Setting<Tool>('orbit'),
  };
  readonly head = new Playhead(kHz);
  readonly link: PeerLink;
  readonly view: SceneView;
  readonly contacts: ContactBook;
  readonly selection: Selection;
  readonly insight: Insight;
  // What a script on the page may listen to: "select", "scene" and "event" (one of the daemon's).
  readonly happenings = new EventTarget();
  pictures = 0;
  pictureWork_ms = 0; // of our own code in the last picture
  private readonly canvas = make('canvas', { class: 'picture', tabindex: 0, role: 'application', 'aria-label': 'Picture of the world. Keys go to its sensors.' });
  private readonly theme = new ThemeChoice();
  private readonly help = new Help();
  private readonly header = new Header(this.theme, () => this.help.open());
  private readonly notices = new Notices();
  private readonly anchors = new AnchorOffer((viewpoint) => this.view.visit(viewpoint));
  private readonly log = new LogPanel();
  private readonly peersPanel = new PeersPanel();
  private readonly charts = new ChartsPanel();
  private readonly objects: ObjectsPanel;
  private readonly tree = new TreePanel((path) => this.select(path));
  private readonly inspector: InspectorPanel;
  private readonly world: WorldPanel;
  private readonly toolbar: Toolbar;
  private timeline: Timeline | RunTimeline;
  private readonly layout: Layout;
  readonly hand: Hand;
  private readonly sensors: Sensors;
  readonly avatar: Avatar;
  private readonly wish = new Vector3();
  private readonly proximity = new Proximity((request) => this.edit(request));
  private readonly labels = new Labels(() => this.head.book);
  private readonly thresholds = new ThresholdMarks(() => this.head.book);
  private readonly truth = new TruthShapes(() => this.head.book);
  private readonly contactMarks: ContactMarks;
  recorded: RecordedPage | null = null; // the page shows a recording
  private readonly offline = make('div', { class: 'offline', role: 'alert', hidden: true });
  private readonly scene = new SceneLoader('api/v1/scene.glb', (file) => this.showScene(file), (sentence) => this.say('fault', sentence));
  private readonly speedometer = new Speedometer();
  private drawUntil_s = Infinity;
  private picturesDue = 0; // however long they take: what is hidden is known a picture later
  private worldTime_s = NaN;
  private last_s = 0;
  private readonly pose = new Float64Array(7);

  constructor(root: HTMLElement) {
    this.link = new PeerLink(gatewayAddress(location.href), {
      onFrame: (frame) => this.onFrame(frame),
      onEvent: (event) => this.onEvent(event),
      onFault: (sentence) => this.say('fault', sentence),
      onOpen: () => this.onOpen(),
    });
    this.contacts = new ContactBook((peer) => this.link.nameOf(peer));
    this.objects = new ObjectsPanel((peer) => this.link.nameOf(peer), (node) => this.selection.choose(node.index, node.path, true));
    this.inspector = new InspectorPanel({ edit: (r) => this.edit(r), lookAt: () => this.lookAtSelected(), nameOf: (peer) => this.link.nameOf(peer) });
    this.world = new WorldPanel({ edit: (request) => this.edit(request) });
    this.toolbar = new Toolbar(this.options, { visit: (viewpoint) => this.view.visit(viewpoint), fit: () => this.view.fit() });
    this.timeline = new Timeline(this.head, () => this.now_s());
    this.layout = new Layout(this.header.element, this.timeline.element, [this.objects, this.tree, this.peersPanel, this.log], [this.inspector, this.world, this.charts]);
    this.contactMarks = new ContactMarks((since_s, until_s) => this.contacts.inForce(since_s, until_s));
    this.layout.stage.append(this.canvas, this.labels.element, this.contactMarks.element, this.toolbar.element, this.offline, this.anchors.element, this.notices.element);
    root.replaceChildren(this.layout.element, this.help.element);
    this.view = new SceneView(this.canvas);
    if (this.view.whyBlind !== null) this.layout.stage.append(blindNote(this.view.whyBlind));
    this.view.overlays.push(new SelectionBox(this.view), this.thresholds, this.truth, this.contactMarks, this.labels);
    this.selection = new Selection(this.link, this.inspector);
    this.selection.onChange = (node) => this.onSelected(node);
    this.insight = new Insight(this.view, (request) => this.link.ask(request), this.options, {
      selectedPath: () => this.selection.path,
      drawSoon: () => this.drawSoon(),
      onFault: (sentence) => this.say('fault', sentence),
    });
    this.hand = new Hand(this.view, this.link, {
      onHolds: (path) => this.onHolds(path),
      onRefused: (sentence) => this.say('refused', sentence),
      onStays: (path) => this.say('refused', `${path} stays where it was let go: nothing pulls it down (a world has gravity by its WorldInfo)`),
    });
    this.avatar = new Avatar(this.link, this.view.rig.camera, { onChange: (path) => this.onWalks(path), onRefused: (sentence) => this.say('refused', sentence) });
    this.sensors = new Sensors(this.canvas, this.view, {
      edit: (request) => this.edit(request),
      mayEdit: () => this.link.mayEdit.value,
      isLive: () => this.head.state === 'live',
      worldTime_s: () => this.worldTime_s,
      onRefused: (sentence) => this.say('refused', sentence),
      onPreview: () => this.drawSoon(),
    });
    const pointer = this.pointerTools();
    this.options.tool.follow((tool) => this.useTool(pointer, tool));
    new Keys(this.canvas, this.view.rig, (request) => this.link.ask(request), {
      cameraKeys: () => this.options.cameraKeys.value || this.options.tool.value === 'walk',
      mayEdit: () => this.link.mayEdit.value,
      onKey: (sentence, done) => this.say(done ? 'done' : 'refused', sentence),
    });
    this.followSettings();
    this.followLink();
    this.watchSurface();
  }

  start(): void {
    void askForRecording()
      .catch(() => null) // then there is no peer either, and the link says so
      .then((recording) => (recording === null ? this.link.open() : this.showRecording(recording)));
    setInterval(() => this.updatePanels(), kPanels_ms);
    setInterval(() => this.sampleErrors(), kErrors_ms);
    requestAnimationFrame(() => this.picture());
  }

  now_s(): number {
    return performance.now() / 1000;
  }

  select(path: string): boolean {
    const { file } = this.view;
    if (file === null || !hasNode(file, path)) return false;
    this.selection.choose(nodeAround(file, path), path, file.byPath.has(path));
    return true;
  }

  private async showRecording(recording: Recording): Promise<void> {
    const page = new RecordedPage(recording, {
      head: this.head,
      link: this.link,
      contacts: this.contacts,
      header: this.header,
      log: this.log,
      showScene: (file) => this.showScene(file),
      drawSoon: () => this.drawSoon(),
      fault: (sentence) => this.say('fault', sentence),
    });
    this.recorded = page;
    this.timeline.element.replaceWith(page.timeline.element);
    this.timeline = page.timeline;
    this.charts.showRecorded(page.charts);
    this.peersPanel.showRecorded(recording);
    this.layout.badge('peers', recording.peers.length);
    this.toolbar.showRecorded(recording.kind === 'run');
    this.world.showRecorded();
    this.selection.recordedOf = (node) => {
      const { owner, flags } = this.head.book.shown;
      return { owner: owner[node], own: (flags[node] & PoseFlag.own) !== 0, driven: (flags[node] & PoseFlag.driven) !== 0 };
    };
    this.watchTimeline();
    await page.show(0);
  }

  private onOpen(): Promise<void> {
    return this.scene.load().then(async () => {
      for (const request of [{ do: 'subscribe' }, { do: 'watch', hz: kHz, kinds: ['shown', 'truth', 'ghost'], looks: true }]) {
        const reply = await this.link.ask(request);
        if (!reply.ok) this.say('fault', `${request.do}: ${reply.error ?? ''}`);
      }
    });
  }

  private showScene(file: SceneFile): void {
    this.view.show(file);
    this.sensors.onScene();
    this.head.show(file);
    this.header.setWorld(file.extras.world ?? '');
    this.toolbar.showViewpoints(file.extras.viewpoints ?? []);
    this.objects.show(file);
    this.tree.show(file);
    this.world.show(file);
    this.selection.follow(file);
    this.view.selected = this.selection.node;
    void this.insight.refresh(true);
    this.layout.badge('objects', file.nodes.length);
    this.happened('scene', file.revision);
    this.drawSoon();
  }

  private onFrame(frame: PoseFrame): void {
    this.head.onFrame(frame, this.now_s());
    this.worldTime_s = frame.worldTime_s;
    if ((frame.rowCount > 0 || frame.looks.length > 0) && this.head.state === 'live') this.drawSoon();
  }

  private onEvent(event: DaemonEvent): void {
    if (event.event === 'scene') {
      void this.scene.load();
      return;
    }
    const concerns = this.contacts.take(event);
    this.happened('event', event);
    if (event.event !== 'contacts_retracted' || concerns > 0) this.log.add(event.event === 'contact' ? 'contact' : 'event', eventText(event, (peer) => this.link.nameOf(peer)));
    if (event.event === 'owner' && event['object'] === this.selection.path) void this.selection.refresh();
    this.drawSoon();
  }

  private async edit(request: Record<string, unknown>): Promise<Outcome> {
    const outcome = await this.link.edit(request);
    this.say(outcome.done ? 'done' : 'refused', outcome.sentence);
    void this.selection.refresh();
    return outcome;
  }

  private say(kind: LogKind, sentence: string): void {
    this.log.add(kind, sentence);
    if (kind === 'refused' || kind === 'fault') this.notices.show(sentence, true);
  }

  private onSelected(node: number | null): void {
    this.view.selected = node;
    this.tree.select(this.selection.path);
    void this.insight.refresh();
    this.happened('select', this.selection.path);
    void this.recorded?.select(this.view.file?.nodes.find((one) => one.index === node && one.path === this.selection.path)?.id ?? null);
    if (node !== null) this.layout.show('object');
    this.updateInspector();
    this.drawSoon();
  }

  private onHolds(path: string | null): void {
    this.canvas.classList.toggle('holding', path !== null);
    if (path === null) this.view.rig.frozen = false;
  }

  private onPicked(hit: Hit | null): void {
    if (hit === null) this.selection.clear();
    else this.selection.choose(hit.node, hit.path, this.view.file?.byPath.has(hit.path) ?? false);
    const extras = this.view.file?.extras;
    const anchor = anchorAround(hit?.shape?.path ?? '', extras?.groups ?? []);
    if (anchor === null) this.anchors.hide();
    else this.anchors.show(anchor, extras?.viewpoints ?? []);
  }

  private pointerTools(): PointerTools {
    return new PointerTools(this.canvas, this.view, this.link, this.hand, {
      onPicked: (hit) => this.onPicked(hit),
      onPickedThen: (index) => {
        const node = this.view.file?.nodes.find((candidate) => candidate.index === index);
        if (node === undefined) this.selection.clear();
        else this.selection.choose(node.index, node.path, true);
      },
      onRefused: (sentence) => this.say('refused', sentence),
      mayTake: () => this.link.mayEdit.value,
      isLive: () => this.head.state === 'live',
      now_s: () => this.now_s(),
    });
  }

  private useTool(pointer: PointerTools, tool: Tool): void {
    pointer.tool = tool;
    this.view.rig.mode = cameraModeOf(tool);
    this.canvas.dataset['tool'] = tool;
    if (tool === 'walk') void this.beginToWalk();
    else void this.avatar.leave();
  }

  // Where the middle of the picture meets the world; where it meets nothing, where the camera is.
  private async beginToWalk(): Promise<void> {
    const { camera } = this.view.rig;
    if (!this.link.mayEdit.value || this.view.file === null) {
      this.say('refused', 'this page is read-only: it has no token, so nobody walks');
      this.options.tool.value = 'fly';
      return;
    }
    const hit = await pick((request) => this.link.ask(request), camera.position, camera.getWorldDirection(new Vector3()));
    const eye = camera.position.clone();
    const { extras } = this.view.file;
    const { height_m, step_m } = sizesOf(extras);
    if (hit !== null && typeof hit !== 'string') {
      const below = async (place: Vector3): Promise<Vector3 | null> => {
        const met = await pick((request) => this.link.ask(request), place.clone().setY(place.y + height_m), new Vector3(0, -1, 0));
        return met === null || typeof met === 'string' ? null : new Vector3(...met.position_m);
      };
      eye.copy(await walkStart(new Vector3(...hit.position_m), camera.position, step_m, below)).add(new Vector3(0, height_m + kDrop_m, 0));
    }
    await this.avatar.enter(eye, extras);
    if (this.avatar.path === null && this.options.tool.value === 'walk') this.options.tool.value = 'fly';
  }

  private onWalks(path: string | null): void {
    this.view.eyeOf = path;
    if (path === null && this.options.tool.value === 'walk') this.options.tool.value = 'fly';
    this.drawSoon();
  }

  private lookAtSelected(): void {
    const { path } = this.selection;
    const node = this.view.file?.nodes.find(({ index }) => index === this.selection.node); // what it goes with
    const place = new Vector3();
    if (node !== undefined && this.view.frames?.position(node.index, place) === true) this.view.rig.lookAt(place, this.view.radiusOf(node));
    const box = path === null || node !== undefined ? new Box3() : this.view.standingBox(path);
    if (!box.isEmpty()) this.view.rig.lookAt(box.getCenter(place), box.getSize(new Vector3()).length() / 2);
    this.drawSoon();
  }

  private followSettings(): void {
    const { options } = this;
    options.ownerColours.follow((on) => (this.view.colouring = on ? 'owner' : 'world'));
    options.ghosts.follow((on) => (this.view.showsGhosts = on));
    options.truth.follow((on) => (this.truth.visible = on));
    options.occlusion.follow((on) => (this.view.leavesOutHidden = on));
    options.thresholds.follow((on) => (this.thresholds.visible = on));
    options.contacts.follow((on) => (this.contactMarks.visible = on));
    options.labels.follow((on) => (this.labels.visible = on));
    for (const setting of [options.ownerColours, options.ghosts, options.truth, options.thresholds, options.contacts, options.labels, options.occlusion]) setting.follow(() => this.drawSoon());
    this.theme.theme.follow(() => {
      this.view.setPageColour(cssColour('--void'));
      this.drawSoon();
    });
  }

  private followLink(): void {
    const { link } = this;
    link.state.follow((state) => {
      this.header.setState(state);
      this.remark();
      if (state === 'closed') this.avatar.forget();
      this.header.setMayEdit(link.mayEdit.value, state, link.token.value);
    });
    link.mayEdit.follow((mayEdit) => {
      this.header.setMayEdit(mayEdit, link.state.value, link.token.value);
      this.inspector.setMayEdit(mayEdit);
      this.world.setMayEdit(mayEdit);
    });
    link.status.follow((status) => {
      if (status === null) return;
      this.header.setStatus(status);
      this.charts.sampleCounters(this.now_s(), status);
      this.layout.badge('peers', status.members.length);
      this.header.setMayEdit(link.mayEdit.value, link.state.value, link.token.value);
      this.remark();
      void this.selection.refresh();
    });
    link.silent_s.follow(() => this.remark());
    link.peers.follow((peers) => this.peersPanel.update(link.status.value, peers));
  }

  private watchSurface(): void {
    new ResizeObserver(() => {
      this.view.resize(this.layout.stage.clientWidth, this.layout.stage.clientHeight);
      this.drawSoon();
    }).observe(this.layout.stage);
    for (const kind of ['pointerdown', 'pointermove', 'wheel', 'keydown'] as const) this.canvas.addEventListener(kind, () => this.drawSoon(), { passive: true });
    this.canvas.addEventListener('pointerdown', () => this.canvas.focus({ preventScroll: true }));
    this.toolbar.element.addEventListener('click', () => this.drawSoon());
    this.toolbar.element.addEventListener('change', () => this.drawSoon());
    this.watchTimeline();
  }

  private watchTimeline(): void {
    for (const kind of ['input', 'change', 'click'] as const) this.timeline.element.addEventListener(kind, () => this.drawSoon());
  }

  private happened(name: string, detail: unknown): void {
    this.happenings.dispatchEvent(new CustomEvent(name, { detail }));
  }

  private drawSoon(): void {
    this.picturesDue = kLeastPictures;
    this.drawUntil_s = Math.max(this.now_s() + kStillFor_s, this.drawUntil_s === Infinity ? 0 : this.drawUntil_s);
  }

  private picture(): void {
    requestAnimationFrame(() => this.picture());
    const now_s = this.now_s();
    const elapsed_s = now_s - this.last_s;
    this.last_s = now_s;
    this.hand.update(now_s);
    if (this.view.file !== null) this.avatar.update(now_s, elapsed_s, this.view.rig.wish(this.wish), this.view.file.extras);
    if (this.avatar.path !== null) this.drawSoon();
    this.recorded?.follow();
    this.head.advance(elapsed_s);
    if (this.head.state === 'playing') this.drawSoon();
    if (now_s > this.drawUntil_s && this.picturesDue <= 0) return;
    this.picturesDue -= 1;
    this.view.takeLooks(this.head.looks.drain());
    this.view.place(this.head.book.shown, this.head.book.ghost, this.head.shownAt(now_s), Math.min(0.25, elapsed_s));
    this.workProximity();
    this.pictureWork_ms = performance.now() - 1000 * now_s;
    this.view.render();
    this.pictures += 1;
  }

  // The camera on its way to a viewpoint is nobody's place.
  private workProximity(): void {
    const { view, link, head, worldTime_s } = this;
    if (!link.mayEdit.value || link.state.value !== 'open' || head.state !== 'live' || view.rig.travels || Number.isNaN(worldTime_s)) return;
    this.proximity.update(view.rig.camera.position, worldTime_s, view.file?.extras.sensors ?? [], view.frames);
  }

  private sampleErrors(): void {
    if (this.head.state !== 'live' || this.link.state.value !== 'open') return;
    this.charts.sampleErrors(this.now_s(), this.head.book, this.view.file?.nodes ?? [], this.selection.movingNode);
  }

  private updatePanels(): void {
    this.timeline.update();
    this.timeline.showMarks(this.contacts.all().filter((contact) => !contact.retracted).map((contact) => contact.event.at_s));
    if (this.layout.isShown('objects')) this.objects.update(this.head.book.shown, this.selection.movingNode);
    if (this.layout.isShown('charts')) this.charts.draw(this.recorded === null ? this.now_s() : this.head.shownAt(0));
    if (this.recorded !== null) this.showRemark(this.recorded.remark);
    if (this.layout.isShown('object')) this.updateInspector();
  }

  // What whoever looks at the picture has to know of it.
  private remark(): void {
    const { state, silent_s, status } = this.link;
    this.showRemark(remarkOn(state.value, silent_s.value, status.value));
  }

  private showRemark(sentence: string): void {
    this.offline.hidden = sentence === '';
    if (sentence !== '') this.offline.textContent = sentence;
  }

  private updateInspector(): void {
    const node = this.selection.movingNode;
    if (node === null) {
      if (this.selection.path !== null) this.inspector.update({ place: null, speed_m_s: NaN, error_m: NaN, threshold_m: NaN });
      return;
    }
    const { shown } = this.head.book;
    const time_s = this.head.shownAt(this.now_s());
    if (this.recorded !== null) void this.selection.refresh(); // its owner may be another one
    const place = shown.sample(node, time_s, this.pose) ? this.pose : null;
    const own = (shown.flags[node] & PoseFlag.own) !== 0;
    this.inspector.update({
      place,
      speed_m_s: this.speedometer.read(node, time_s, place),
      error_m: own || this.recorded !== null ? this.head.book.errorOf(node, time_s) : NaN,
      threshold_m: shown.threshold_m[node] ?? NaN,
    });
  }
}
