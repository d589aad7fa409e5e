// The speed of what is selected, from two readings of its place [m/s]; NaN before there are two.
export class Speedometer {
  private subject = -1;
  private time_s = NaN;
  private speed_m_s = NaN;
  private readonly place = [NaN, NaN, NaN];

  read(subject: number, time_s: number, place: ArrayLike<number> | null): number {
    if (place === null) return NaN;
    const since_s = time_s - this.time_s;
    if (this.subject !== subject || since_s < 0) this.speed_m_s = NaN;
    else if (since_s > 0) this.speed_m_s = Math.hypot(place[0] - this.place[0], place[1] - this.place[1], place[2] - this.place[2]) / since_s;
    for (let axis = 0; axis < 3; ++axis) this.place[axis] = place[axis];
    this.time_s = time_s;
    this.subject = subject;
    return this.speed_m_s;
  }
}
