#include "replication/physics/world/contact_answer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "replication/physics/laws/response.hpp"

namespace peerd::replication {
namespace {

MotionModel motion_after_response(const WorldModel& model, const MovingObjects& objects, std::size_t object,
                                  const WatchedPair& pair, const MotionModel& self, const KinematicState& other,
                                  OtherSide other_side, const Vec3& n, bool is_decided_here) {
  const MovingObject& o = objects[object];
  const CollisionResponse* const response = model.response_of(o.id);
  assert(response != nullptr && pair.contact);
  const MovingObject& met = objects[pair.collider == object ? pair.collidee : pair.collider];
  KinematicState after = respond({*response, model.response_of(met.id), other_side, self.state, other, n});
  // At a contact time the object still stands where it did not collide; only an overlap leaves something to set back.
  // The place where the object was last known to be free depends on when this peer searched. So an impulse sets an
  // object back at its owner, and at the peer that decides for all. A prediction leaves it where it is, because peers
  // would predict different places.
  const bool sets_back = response->set_back && (response->type != ResponseType::kImpulse || is_decided_here ||
                                                o.role == Role::kAuthoritative);
  if (pair.overlapped && sets_back && pair.free_at) {
    const Vec3 back = objects.world_at(object, *pair.free_at).position;
    // An object that is set back against its weight takes the work from its speed, or stays.
    const double left = after.velocity.squaredNorm() + 2.0 * after.acceleration.dot(back - after.position);
    if (left >= after.velocity.squaredNorm()) {
      after.position = back;
    } else if (left >= 0.0) {
      after.velocity *= std::sqrt(left / after.velocity.squaredNorm());
      after.position = back;
    }
  }
  if (moves_alike(after, self.state)) return self;
  if (response->type == ResponseType::kImpulse) return law_after(response, self, after);
  return after_contact(self, after, n, response->type == ResponseType::kInverse);
}

}  // namespace

bool ContactAnswer::changes_motion() const {
  return !moves_alike(before_a.state, after_a.state) || !moves_alike(before_b.state, after_b.state);
}

ContactAnswer answer_to(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                        ContactAuthority authority) {
  assert(pair.contact);
  const SimTime t = *pair.contact;
  const MovingObject &a = objects[pair.collider], &b = objects[pair.collidee];
  ContactAnswer answer;
  answer.authority = authority;
  const auto answers = [&](const MovingObject& o, bool registered) {
    const bool could_not_know = answer.authority != ContactAuthority::kAsPublished && o.role == Role::kPredicted;
    return o.will_respond(registered, could_not_know ? SimTime::max() : t);
  };
  answer.a_responds = answers(a, pair.collider_responds);
  answer.b_responds = answers(b, pair.collidee_responds);
  answer.before_a = answer.after_a = objects.world_law(pair.collider, t);
  answer.before_b = answer.after_b = objects.world_law(pair.collidee, t);
  const KinematicState &state_a = answer.before_a.state, &state_b = answer.before_b.state;
  const auto other_side = [&](const MovingObject& o, bool registered, bool responds) {
    if (!o.is_answering()) return OtherSide::kGoesOn;
    const bool takes_part = registered && (responds || is_in_later_update(o, pair));
    return takes_part ? OtherSide::kAnswers : OtherSide::kAnswersApart;
  };
  // This peer also decides what its own object does to a scene object that nobody owns.
  const bool is_decided_here =
      authority == ContactAuthority::kLocal || (authority == ContactAuthority::kAsPublished &&
                                                (a.role == Role::kAuthoritative || b.role == Role::kAuthoritative));
  if (answer.a_responds) {
    const OtherSide other = other_side(b, pair.collidee_responds, answer.b_responds);
    answer.after_a = motion_after_response(model, objects, pair.collider, pair, answer.before_a, state_b, other,
                                           pair.normal, is_decided_here);
  }
  if (answer.b_responds) {
    const OtherSide other = other_side(a, pair.collider_responds, answer.a_responds);
    answer.after_b = motion_after_response(model, objects, pair.collidee, pair, answer.before_b, state_a, other,
                                           -pair.normal, is_decided_here);
  }
  return answer;
}

ContactAnswer answer_to_closing(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                                const ContactAnswer& answer) {
  assert(!answer.changes_motion());
  ContactAnswer spinless = answer;
  const KinematicState &a = answer.after_a.state, &b = answer.after_b.state;
  const auto turns = [](bool responds, const KinematicState& s) {
    return responds && !s.angular_velocity_body.isZero(0.0);
  };
  const bool a_turns = turns(answer.a_responds, a), b_turns = turns(answer.b_responds, b);
  const auto stop_spin = [](MotionModel& law) {
    law.state.angular_velocity_body.setZero();
    law.angular_acceleration_body.setZero();
  };
  if (a_turns) stop_spin(spinless.after_a);
  if (b_turns) stop_spin(spinless.after_b);
  if (a_turns || b_turns) return spinless;
  const Vec3 approach = a.velocity - b.velocity;
  const double speed = approach.norm();
  if (pair.normal.dot(approach) <= 0x1p-30 * speed) return answer;  // they graze
  WatchedPair back = pair;
  back.normal = -approach / speed;
  return answer_to(model, objects, back, answer.authority);
}

bool lasts_at(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair) {
  assert(pair.contact);
  if (pair.resting) return true;
  const ContactAnswer answer = answer_to(model, objects, pair, ContactAuthority::kAsPublished);
  const Vec3& n = pair.normal;
  const double approach = -n.dot(answer.before_a.state.velocity - answer.before_b.state.velocity);
  const double acceleration = n.dot(objects.free_acceleration_of(pair.collider, *pair.contact) -
                                    objects.free_acceleration_of(pair.collidee, *pair.contact));
  const bool is_borne = objects[pair.collider].borne_unseen || objects[pair.collidee].borne_unseen;
  if (is_borne && approach <= kRestSpeed_m_s) return true;
  return comes_to_rest(std::max(approach, 0.0), acceleration) && comes_to_rest_at(model, objects, pair, answer);
}

bool exchanges_momentum(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                        const ContactAnswer& answer) {
  const auto takes_part = [&](std::uint32_t object, bool registered, bool responds) {
    const MovingObject& o = objects[object];
    if (responds != o.will_respond(registered, *pair.contact)) return false;
    if (!responds) return !o.is_answering();
    return model.response_of(objects[object].id)->type == ResponseType::kImpulse;
  };
  return takes_part(pair.collider, pair.collider_responds, answer.a_responds) &&
         takes_part(pair.collidee, pair.collidee_responds, answer.b_responds);
}

bool comes_to_rest_at(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                      const ContactAnswer& answer) {
  assert(pair.contact);
  const Vec3& n = pair.normal;
  if (pair.resting) return true;
  if (pair.overlapped) return false;
  const auto free = [&](std::size_t object, const MotionModel& after) {
    return pair.bears ? objects.free_acceleration_of(object, *pair.contact) : after.state.acceleration;
  };
  const double speed = n.dot(answer.after_a.state.velocity - answer.after_b.state.velocity);
  const double acceleration = n.dot(free(pair.collider, answer.after_a) - free(pair.collidee, answer.after_b));
  const double came = answer.before_a.state.velocity.norm() + answer.before_b.state.velocity.norm();
  if (speed < -kRounding * came) return false;
  if (comes_to_rest(std::max(speed, 0.0), acceleration)) return true;
  return speed <= kRounding * came && exchanges_momentum(model, objects, pair, answer);
}

double own_energy_of_parting_j(const WorldModel& model, const MovingObjects& objects, const WatchedPair& pair,
                               const ContactAnswer& answer) {
  const double speed = pair.normal.dot(answer.after_a.state.velocity - answer.after_b.state.velocity);
  double inverse_mass = 0.0, give_way = 0.0, own = 0.0;
  for (const auto& [object, responds] :
       {std::pair{pair.collider, answer.a_responds}, std::pair{pair.collidee, answer.b_responds}}) {
    const CollisionResponse* const response = model.response_of(objects[object].id);
    if (!responds || response->type != ResponseType::kImpulse) continue;
    inverse_mass += 1.0 / response->mass_kg;
    give_way += 1.0;
    own += objects[object].role == Role::kAuthoritative ? 1.0 : 0.0;
  }
  if (own == 0.0 || speed <= 0.0) return 0.0;
  return own / give_way * 0.5 * speed * speed / inverse_mass;
}

}  // namespace peerd::replication
