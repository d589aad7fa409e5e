// What is known of whether objects can be seen, from the answers of the GPU to questions of earlier pictures.
//
// Only what stands hides. So an answer holds for as long as neither the camera nor the object has moved since it was asked, and
// else for the one picture after that. What no answer says to be hidden is drawn: nothing that can be seen is missing for more
// than one picture, however late the answers come.
const kAgain = 6; // pictures until what is seen is asked for again while something moves

interface Known {
  hidden: boolean;
  view: number; // the camera's and the object's place, by numbers that change with them, when it was asked
  place: number;
  picture: number;
  times: number; // so many answers on end said the same
}

export class OcclusionState {
  private readonly known: (Known | null)[];
  private readonly asked: ({ view: number; place: number; picture: number } | null)[];
  private picture = 0;
  private view = 0;

  constructor(readonly count: number) {
    this.known = new Array<Known | null>(count).fill(null);
    this.asked = new Array<null>(count).fill(null);
  }

  begin(view: number): void {
    this.picture += 1;
    this.view = view;
  }

  isAsked(i: number): boolean {
    return this.asked[i] !== null;
  }

  // The answer to the last question has come.
  answer(i: number, hidden: boolean): void {
    const { [i]: asked } = this.asked;
    if (asked === null) return;
    const times = this.known[i]?.hidden === hidden ? (this.known[i]?.times ?? 0) + 1 : 1;
    this.known[i] = { hidden, ...asked, times };
    this.asked[i] = null;
  }

  // `place` changes whenever the object has moved.
  isLeftOut(i: number, place: number): boolean {
    const { [i]: known } = this.known;
    if (known === null || !known.hidden) return false;
    return this.holds(known, place) || (known.picture === this.picture - 1 && known.times >= 2);
  }

  shouldAsk(i: number, place: number): boolean {
    const { [i]: known } = this.known;
    const { [i]: asked } = this.asked;
    if (asked !== null && asked.view === this.view && asked.place === place) return false; // its answer will hold
    if (known === null) return true;
    if (this.holds(known, place)) return false;
    return known.hidden || this.picture - known.picture >= kAgain + (i % kAgain);
  }

  ask(i: number, place: number): void {
    this.asked[i] = { view: this.view, place, picture: this.picture };
  }

  private holds(known: Known, place: number): boolean {
    return known.view === this.view && known.place === place;
  }
}
