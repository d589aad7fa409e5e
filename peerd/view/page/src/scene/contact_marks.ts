import { ArrowHelper, Color, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3 } from 'three';
import type { ContactEvent } from 'peerd';

import { make, setText } from '../page/make';
import type { Overlay, SceneView } from './scene_view';
import { supportPlace } from './support_place';

// Contacts of the last seconds before the instant that is shown: where, the normal, and who decided.
const kShown_s = 3;
const kMost = 24;
// Labels no nearer than that do not cover each other.
const kLabel_px = { width: 120, height: 24 };
const kColours: Record<ContactEvent['kind'], number> = {
  owner: 0x30a46c,
  decided: 0xe5484d,
  applied: 0x22b8cf,
  predicted: 0xf5b301,
  scene: 0x8b95a3,
};

export interface KnownContact {
  readonly event: ContactEvent;
  readonly decider: string; // its peer's name; empty where nobody decided
  retracted: boolean;
}

interface Mark {
  readonly dot: Mesh<SphereGeometry, MeshBasicMaterial>;
  readonly arrow: ArrowHelper;
  readonly label: HTMLElement;
  contact: KnownContact | null;
}

export class ContactMarks implements Overlay {
  readonly element = make('div', { class: 'labels', 'aria-hidden': 'true' });
  visible = true;
  private readonly marks: Mark[] = [];
  private readonly labelled: { x: number; y: number }[] = []; // places of the labels of this picture
  private readonly ball = new SphereGeometry(1, 12, 8);
  private readonly place = new Vector3();
  private readonly turn = new Quaternion();

  constructor(private readonly contactsIn: (since_s: number, until_s: number) => readonly KnownContact[]) {}

  update(view: SceneView, time_s: number): void {
    this.element.hidden = !this.visible;
    // The newest first: where labels meet, it has its own.
    const contacts = this.visible ? this.contactsIn(time_s - kShown_s, time_s).slice(-kMost).reverse() : [];
    this.labelled.length = 0;
    contacts.forEach((contact, i) => this.show(view, this.marks[i] ?? this.add(view), contact, time_s));
    for (const mark of this.marks.slice(contacts.length)) hide(mark);
  }

  private show(view: SceneView, mark: Mark, contact: KnownContact, time_s: number): void {
    const place = this.placeOf(view, contact.event);
    if (place === null) {
      hide(mark);
      return;
    }
    const size = Math.max(0.02, view.rig.camera.position.distanceTo(place) * 0.006);
    const fresh = Math.max(0, 1 - (time_s - contact.event.at_s) / kShown_s);
    mark.dot.visible = mark.arrow.visible = true;
    mark.dot.position.copy(place);
    mark.dot.scale.setScalar(size);
    mark.dot.material.opacity = 0.35 + 0.65 * fresh;
    mark.arrow.position.copy(place);
    // An arrow that is older is shorter, so that many contacts in one place do not hide what collides there.
    mark.arrow.setLength(size * (2.5 + 4.5 * fresh), size * 2, size);
    if (mark.contact !== contact) this.dress(mark, contact);
    this.placeLabel(view, mark.label, place, fresh);
  }

  private dress(mark: Mark, contact: KnownContact): void {
    const colour = kColours[contact.event.kind];
    mark.contact = contact;
    mark.dot.material.color.set(colour);
    mark.arrow.setColor(new Color(colour));
    mark.arrow.setDirection(new Vector3(...contact.event.normal).normalize());
    setText(mark.label, contact.decider === '' ? '' : `${contact.event.kind === 'owner' ? 'found' : 'decided'} by ${contact.decider}`);
  }

  // A prediction, which nobody has decided, has no label; nor has what lies below a newer one.
  private placeLabel(view: SceneView, label: HTMLElement, place: Vector3, fresh: number): void {
    const p = this.place.copy(place).project(view.rig.camera);
    const x = ((p.x + 1) / 2) * this.element.clientWidth;
    const y = ((1 - p.y) / 2) * this.element.clientHeight;
    const isInWindow = p.z <= 1 && Math.abs(p.x) <= 1 && Math.abs(p.y) <= 1;
    const isFree = !this.labelled.some((other) => Math.abs(other.x - x) < kLabel_px.width && Math.abs(other.y - y) < kLabel_px.height);
    label.hidden = label.textContent === '' || !isInWindow || !isFree;
    if (label.hidden) return;
    this.labelled.push({ x, y });
    label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(12px, -50%)`;
    label.style.opacity = String(0.4 + 0.6 * fresh);
  }

  // The event says where the two objects were; the place of the contact is the collider's outermost towards the collidee.
  private placeOf(view: SceneView, event: ContactEvent): Vector3 | null {
    const node = view.file?.byPath.get(event.collider);
    if (view.file === null || view.frames === null || node === undefined) return null;
    view.frames.orientation(node.index, this.turn);
    const towards = new Vector3(...event.normal).negate();
    const offset = supportPlace(view.file, node.index, this.turn, towards);
    if (event.collider_position_m !== undefined) return offset.add(this.place.set(...event.collider_position_m));
    return view.frames.position(node.index, this.place) ? offset.add(this.place) : null;
  }

  private add(view: SceneView): Mark {
    const material = new MeshBasicMaterial({ transparent: true, depthTest: false, fog: false });
    const dot = new Mesh(this.ball, material);
    const arrow = new ArrowHelper();
    dot.renderOrder = arrow.line.renderOrder = arrow.cone.renderOrder = 3;
    const label = this.element.appendChild(make('span', { class: 'label contact' }));
    view.scene.add(dot, arrow);
    const mark = { dot, arrow, label, contact: null };
    this.marks.push(mark);
    return mark;
  }
}

function hide(mark: Mark): void {
  mark.dot.visible = mark.arrow.visible = false;
  mark.label.hidden = true;
}
