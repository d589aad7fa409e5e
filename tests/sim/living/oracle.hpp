#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "tests/sim/living/oracle_motion.hpp"
#include "tests/sim/living/oracle_soup.hpp"

namespace peerd::living {

// What binary32 may take from a vertex that bends or is scaled, in each coordinate [m]. All that the oracle calls
// certain is so wherever in such a box a vertex is.
inline constexpr double kVertexSlack_m = 5e-7;

// What a peer may be early by, as a distance at the time that it reports [m]: 2e-5 m of path error, 1e-6 m of
// tolerance, and a vertex's slack.
inline constexpr double kEarly_m = 2.2e-5;

// When the surfaces of two nodes of a world touch, in interval arithmetic, from the world's plain data. Of nodes that
// share Shapes, a Shape does not touch itself. Of type kBox, the boxes of all vertices along the world's axes touch,
// and their distance is the largest gap along an axis.
class ContactOracle {
 public:
  ContactOracle(const OracleMotion& motion, const World& world, int collider, int collidee, InterestType type);

  // The distance in the world at a time [m]. Where something jumps then, the range holds both sides' distances, from
  // the less of the lower ends to the less of the upper ones.
  [[nodiscard]] Range distance_m(double t_s);
  // Whether the two certainly touch. Where something jumps then: on either side of it.
  [[nodiscard]] bool touches(double t_s);

  struct Verdict {
    Range distance_m;                       // at the reported time
    double late_s = 0.0;                    // they touch, certainly, for so long before it
    std::optional<double> earlier_touch_s;  // the first time since the last end that they certainly touch at
    double unproven_s = 0.0;                // parts of the time since then for which it is not certain that they don't
    bool complete = true;                   // false: the search was given up
    std::uint64_t placements = 0;
    [[nodiscard]] bool is_early() const { return distance_m.lo > kEarly_m; }
    [[nodiscard]] bool is_late() const { return late_s > 0.0; }
  };
  // Judges a contact that was reported for `t_s`; the two were apart at `since_s`. Conservative advancement: where they
  // are d apart and no point goes faster than v against the other, they do not touch for d / v. Where that is short,
  // they may glide along each other: they do not touch for h if directions part them by more than a h^2 / 8 both now
  // and then, where no point of one is accelerated by more than a against the other.
  [[nodiscard]] Verdict judge(double since_s, double t_s);

 private:
  struct Part {  // a Shape of one of the two
    int node = -1;
    std::vector<int> path;  // of Transforms, from the top
    Soup soup;
    double speed_m_s = 0.0, acceleration_m_s2 = 0.0;  // at most, in the common frame, in the piece
  };
  struct Piece {
    double begin_s = 0.0, end_s = 0.0;
    [[nodiscard]] double middle_s() const { return 0.5 * (begin_s + end_s); }
  };
  std::vector<Part> parts_of(int node) const;
  [[nodiscard]] std::vector<Piece> pieces_at(double t_s) const;
  void set_bounds(std::vector<Part>& parts, double within_s) const;
  // Places all parts in the world, or in the frame of what holds both.
  void place(double t_s, const Piece& piece, bool in_world);
  [[nodiscard]] Range distance_placed() const;
  [[nodiscard]] bool touch_placed() const;
  struct Box;
  [[nodiscard]] static Box box_of(const std::vector<Part>& parts);
  // How far the box of one is beyond that of the other, along each axis in both directions; negative: they overlap.
  [[nodiscard]] std::array<double, 6> box_gaps() const;
  void sweep(double since_s, double t_s, Verdict& verdict);
  void sweep_piece(const Piece& piece, double since_s, double t_s, Verdict& verdict);
  // A time for which the two, who are placed at `at_s`, do not touch: the longest of `longest_s` and its halves, down
  // to kLeastStep_s; 0: it is none of them. `speed_m_s`, `acceleration_m_s2`: of any points against each other, at
  // most.
  [[nodiscard]] double glide_s(const Piece& piece, double at_s, double longest_s, double speed_m_s,
                               double acceleration_m_s2);

  const OracleMotion& motion_;
  const World& world_;
  InterestType type_;
  std::size_t common_ = 0;  // leading nodes of all paths that both share
  std::vector<Part> collider_, collidee_;
  std::vector<Piece> pieces_;
  std::uint64_t placements_ = 0;
};

}  // namespace peerd::living
