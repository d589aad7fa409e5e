#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "tests/sim/living/oracle.hpp"
#include "tests/sim/living/world.hpp"

// What `peerd collide --until` and what peers find in a living world.
namespace peerd::living {

// One collidee of an interest, by nodes of World and, which is the same order, by objects of the scene.
struct Pair {
  int collider = -1, collidee = -1;
  InterestType type = InterestType::kBox;
  ObjectId collider_object, collidee_object;
};

struct Contact {
  std::size_t pair = 0;  // into Reference::pairs
  double began_s = 0.0;  // the tick at which it began: the first one at which the two touch
  double ended_s = 0.0;  // the first one after it at which they are apart; infinite: none
};

struct Reference {
  std::vector<Pair> pairs;
  std::vector<Contact> contacts;      // by began_s
  std::vector<std::string> problems;  // errors and warnings of the world's text; what collide refuses
};

inline constexpr double kReference_hz = 1000.0;

// All contacts of a world, tick by tick, as `peerd collide WORLD --until DURATION --hz 1000` finds them.
[[nodiscard]] Reference reference_of(const World& world);

// The record of a world's scenario, run on the simulated network. `folder` gets its texts: living.wrl and living.toml.
[[nodiscard]] measure::RunRecord run_peers(const World& world, const std::filesystem::path& folder);
void write_texts(const World& world, const std::filesystem::path& folder);

// A contact that every peer has to find: it lasts 2 ms, comes later than a latency and 10 ms after the start, when what
// is owned begins to move, and a tenth of a second before the end.
[[nodiscard]] bool must_be_found(const World& world, const Contact& contact);

// From when on [s] every peer knows how all moves.
[[nodiscard]] double known_from_s(const World& world);

inline constexpr double kAgreed_s = 0.002;

struct Missing {
  Contact contact;
  PeerId peer;
  std::optional<double> nearest_s;  // the peer's nearest row of that pair
};
struct Comparison {
  std::size_t compared = 0;                  // contacts that must be found, times the peers
  std::vector<Missing> missing;              // of these, those without a row of that peer within kAgreed_s
  std::vector<measure::ContactRow> besides;  // rows of an interest's pair that no contact began within kAgreed_s of
};
[[nodiscard]] Comparison compare(const World& world, const Reference& reference, const measure::RunRecord& record);

// The pairs that a row can be about: where it says its type, one at most.
[[nodiscard]] std::vector<std::size_t> pairs_of(const Reference& reference, const measure::ContactRow& row);

// A row of which the oracle says for certain that it is wrong. Rows from the time before the peer can know how what
// others own moves are left out, and those of contacts that have begun in that time.
struct Fault {
  measure::ContactRow row;
  std::size_t pair = 0;
  ContactOracle::Verdict verdict;
};
struct Judgement {
  std::size_t judged = 0;  // rows
  std::vector<Fault> faults;
  double unproven_s = 0.0;     // of all rows
  std::size_t incomplete = 0;  // rows for which the oracle has given up
};
// Judges rows of interests: of one that may be about several pairs, the pair counts that suits it best.
[[nodiscard]] Judgement judge(const World& world, const Reference& reference,
                              const std::vector<measure::ContactRow>& rows);

[[nodiscard]] std::string text_of(const World& world, const Reference& reference, const Missing& missing);
[[nodiscard]] std::string text_of(const World& world, const Reference& reference, const Fault& fault);

}  // namespace peerd::living
