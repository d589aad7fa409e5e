#pragma once
#include <random>
#include <string>
#include <vector>

#include "replication/wire/operation.hpp"

// Random operations as a peer could make them.
namespace peerd::replication::test {

class OperationMaker {
 public:
  explicit OperationMaker(std::uint64_t seed) : random_(seed) {}

  Operation operation(OperationId id) {
    Operation o{id, SimTime{Duration{1'000'000 * std::int64_t{id.number}}}, body()};
    std::uint32_t author = 0;
    for (auto i = random_() % 3; i > 0; --i) {
      o.knows.push_back({AuthorId{author += 1 + number() % 1'000'000}, number() | 1});
    }
    return o;
  }
  // Of about that size.
  Operation large(OperationId id, std::size_t bytes) {
    Operation o = operation(id);
    o.body = AddNodes{{}, {}, std::string(bytes, 'x'), 1, 1, {}};
    return o;
  }
  OperationBody body() {
    switch (random_() % 14) {
      case 0: {
        AddNodes a{place(), place(), text(300), number(), number(), {}};
        for (auto i = random_() % 3; i > 0; --i) a.names.emplace_back(text(12), object());
        return a;
      }
      case 1:
        return RemoveObject{object()};
      case 2:
        return RemoveNode{node()};
      case 3:
        return MoveObject{object(), place(), place()};
      case 4:
        return SetField{node(), text(20), text(90), number()};
      case 5:
        return ChangeRoute{node(), node(), text(20), text(20), random_() % 2 == 0};
      case 6: {
        GiveObject give{object(), PeerId{number()}, PeerId{number() % 3}, {}};
        if (random_() % 2 == 0) give.placement = {{1.5f, -2, 1e-30f}, {0, 1, 0, 3.1415927f}};
        return give;
      }
      case 11:
        return PlaceObject{
            object(), PeerId{number() | 1}, SimTime{Duration{number()}}, {{1.5f, -2, 1e-30f}, {1, 0, 0, 0}}};
      case 7:
        return RequestObject{object(), PeerId{number() | 1}, PeerId{number() | 1}};
      case 8:
        return SetData{node(), text(20), random_() % 3 == 0 ? std::nullopt : std::optional(text(90))};
      case 9:
        return SendMessage{PeerId{number() | 1}, text(20), text(90)};
      case 10:
        return UndoOperation{number() | 1, SimTime{Duration{number()}}, random_() % 2 == 0};
      case 12:
        return LockObject{object(), random_() % 2 == 0};
      default:
        return RefuseRequest{{AuthorId{number() % kAuthorMax + 1}, number() | 1}, text(60)};
    }
  }
  std::uint64_t random() { return random_(); }

 private:
  std::uint32_t number() { return static_cast<std::uint32_t>(random_()); }
  ObjectId object() { return ObjectId{number(), number() % (kAuthorMax + 1)}; }
  NodeId node() { return NodeId{number(), number() % 3}; }
  std::optional<ObjectId> place() { return random_() % 2 == 0 ? std::nullopt : std::optional(object()); }
  // Any bytes but NUL, one at least.
  std::string text(std::size_t most) {
    std::string text(1 + random_() % most, ' ');
    for (char& c : text) c = static_cast<char>(1 + random_() % 255);
    return text;
  }
  std::mt19937_64 random_;
};

inline bool same(const Operation& a, const Operation& b) {
  return a.id == b.id && a.stamp == b.stamp && a.body == b.body && a.knows == b.knows;
}

// A log of so many operations, as bytes.
inline std::vector<std::byte> log_of(AuthorId author, std::uint32_t count, std::uint64_t seed,
                                     std::vector<Operation>* operations = nullptr) {
  OperationMaker make(seed);
  std::vector<std::byte> bytes;
  for (std::uint32_t number = 1; number <= count; ++number) {
    const Operation o = make.operation({author, number});
    const auto encoded = encode(o);
    bytes.insert(bytes.end(), encoded.begin(), encoded.end());
    if (operations != nullptr) operations->push_back(o);
  }
  return bytes;
}

}  // namespace peerd::replication::test
