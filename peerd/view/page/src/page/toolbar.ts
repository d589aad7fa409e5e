import type { CameraMode } from '../scene/camera_rig';
import type { Viewpoint } from '../scene/scene_file';
import type { Tool } from '../hand/pointer_tools';
import { icon, type IconName } from './icons';
import { make } from './make';
import type { Setting } from './setting';

// Over the picture: what the pointer does, the viewpoints, what is drawn, and where keys go.
export interface Options {
  readonly ownerColours: Setting<boolean>;
  readonly ghosts: Setting<boolean>;
  readonly truth: Setting<boolean>; // of recordings
  readonly thresholds: Setting<boolean>;
  readonly contacts: Setting<boolean>;
  readonly labels: Setting<boolean>;
  readonly proximity: Setting<boolean>;
  readonly regions: Setting<boolean>;
  readonly hierarchy: Setting<boolean>;
  readonly hierarchyLevel: Setting<number>;
  readonly occlusion: Setting<boolean>;
  readonly hierarchyText: Setting<string>; // what is shown of it
  readonly cameraKeys: Setting<boolean>;
  readonly tool: Setting<Tool>;
}

export interface ToolbarActions {
  visit(viewpoint: Viewpoint): void;
  fit(): void;
}

const kTools: readonly { tool: Tool; name: IconName; title: string; hint: string }[] = [
  { tool: 'orbit', name: 'orbit', title: 'Orbit', hint: 'Drag turns the camera around the world; a click selects' },
  { tool: 'fly', name: 'fly', title: 'Fly', hint: 'Drag looks around; a click selects' },
  { tool: 'walk', name: 'walk', title: 'Walk', hint: 'Be in the world as an avatar that all see: drag looks around, W A S D and the arrows walk' },
  { tool: 'hand', name: 'hand', title: 'Hand', hint: 'Drag an object to grab it, let go to throw it' },
];

// What asks a running peer.
const kOfRunningPeers = '[data-tool=hand], [data-tool=walk], [data-option=proximity], [data-option=regions], [data-option=hierarchy]';

export class Toolbar {
  readonly element: HTMLElement;
  private readonly viewpoints = make('select', { 'aria-label': 'Viewpoint' });
  private readonly truth: HTMLElement;
  private known: readonly Viewpoint[] = [];

  constructor(private readonly options: Options, private readonly actions: ToolbarActions) {
    this.viewpoints.addEventListener('change', () => this.visit());
    this.truth = check('Truth', 'where the objects of others really are', options.truth, 'truth');
    this.truth.hidden = true;
    this.element = make(
      'div',
      { class: 'toolbar', role: 'toolbar', 'aria-label': 'Picture' },
      this.tools(),
      this.viewpoints,
      make('button', { type: 'button', class: 'tool', title: 'All of the world', 'aria-label': 'Show all of the world', click: () => actions.fit() }, icon('fit')),
      this.showMenu(),
    );
    this.showViewpoints([]);
  }

  showViewpoints(viewpoints: readonly Viewpoint[]): void {
    this.known = viewpoints;
    this.viewpoints.replaceChildren(
      make('option', { value: '' }, 'Viewpoint'),
      ...viewpoints.map((viewpoint, i) => make('option', { value: String(i) }, viewpoint.description || `Viewpoint ${i + 1}`)),
    );
    this.viewpoints.hidden = viewpoints.length === 0;
  }

  // The page shows a recording, which may know where everything really is.
  showRecorded(knowsTruth: boolean): void {
    this.truth.hidden = !knowsTruth;
    for (const control of this.element.querySelectorAll<HTMLButtonElement | HTMLInputElement>(kOfRunningPeers)) {
      control.disabled = true;
      (control.closest('label') ?? control).title = 'Only a running peer has it: this is a recording';
    }
  }

  private visit(): void {
    const viewpoint = this.known[Number(this.viewpoints.value)];
    if (this.viewpoints.value !== '' && viewpoint !== undefined) this.actions.visit(viewpoint);
    this.viewpoints.value = '';
  }

  private tools(): HTMLElement {
    const group = make('div', { class: 'segments', role: 'radiogroup', 'aria-label': 'What the pointer does' });
    for (const { tool, name, title, hint } of kTools) {
      const choose = (): void => void (this.options.tool.value = tool);
      const button = make('button', { type: 'button', role: 'radio', class: 'segment', title: hint, 'data-tool': tool, click: choose }, icon(name), make('span', {}, title));
      this.options.tool.follow((chosen) => button.setAttribute('aria-checked', String(chosen === tool)));
      group.append(button);
    }
    return group;
  }

  private showMenu(): HTMLElement {
    const { options } = this;
    const menu = make(
      'details',
      { class: 'menu' },
      make('summary', { class: 'tool wide', 'aria-label': 'What is drawn' }, icon('layers'), make('span', {}, 'Show')),
      make(
        'div',
        { class: 'menu-body' },
        check('Colours by owner', 'red: this peer’s, cyan: another peer’s, grey: nobody’s', options.ownerColours, 'owner-colours'),
        check('Ghosts', 'where all others predict this peer’s objects', options.ghosts, 'ghosts'),
        this.truth,
        check('Thresholds', 'how far a ghost may be wrong before an update', options.thresholds, 'thresholds'),
        check('Contacts', 'with normals and the deciding peer', options.contacts, 'contacts'),
        check('Labels', 'names of objects', options.labels, 'labels'),
        check('Proximity spheres', 'where they meet, a collision may be near: red ones have a tight threshold', options.proximity, 'proximity'),
        check('Regions', 'blue: joined; red edge: own objects are in it', options.regions, 'regions'),
        check('Hierarchy', 'the 18-DOPs of the selected object', options.hierarchy, 'hierarchy'),
        levelSlider(options),
        make('hr', {}),
        check('Leave out what is hidden', 'Shapes of many triangles behind others are not drawn', options.occlusion, 'occlusion'),
        check('Keys move the camera', 'else they go to the world’s KeySensors', options.cameraKeys, 'camera-keys'),
      ),
    );
    document.addEventListener('pointerdown', (event) => {
      if (!menu.contains(event.target as Node)) menu.open = false;
    });
    menu.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      menu.open = false;
      menu.querySelector('summary')?.focus();
    });
    return menu;
  }
}

function check(title: string, hint: string, setting: Setting<boolean>, name: string): HTMLElement {
  const input = make('input', { type: 'checkbox', 'data-option': name });
  input.addEventListener('change', () => (setting.value = input.checked));
  setting.follow((on) => (input.checked = on));
  return make('label', { class: 'check' }, input, make('span', {}, make('span', { class: 'check-title' }, title), make('span', { class: 'muted small' }, hint)));
}

const kDeepest = 16;

function levelSlider({ hierarchy, hierarchyLevel, hierarchyText }: Options): HTMLElement {
  const input = make('input', { type: 'range', min: 0, max: kDeepest, step: 1, 'aria-label': 'Level of the hierarchy', 'data-option': 'hierarchy-level' });
  const text = make('output', { class: 'muted small' });
  const row = make('div', { class: 'level-row' }, input, text);
  input.addEventListener('input', () => (hierarchyLevel.value = Number(input.value)));
  hierarchyLevel.follow((level) => (input.value = String(level)));
  hierarchyText.follow((sentence) => (text.textContent = sentence));
  hierarchy.follow((on) => (row.hidden = !on));
  return row;
}

export function cameraModeOf(tool: Tool): CameraMode {
  return tool === 'hand' ? 'orbit' : tool;
}
